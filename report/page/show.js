"use strict";
// The page of a show on a farm, from what `farm report --json` writes.

const mostRows = 25;

// A row of each, as far as they fit, and how many are left out.
function limitedTable(title, heads, all, cells) {
  const more = `${all.length - mostRows} more are in the JSON of the report.`;
  const rows = all.slice(0, mostRows).map(cells);
  return section(title, table(heads, rows), all.length > mostRows ? paragraph(more) : null);
}

function elementTable(title, heads, elements, cells) {
  if (elements.length === 0) return null;
  const rowOf = (one) => [one.shot, one.element, ...cells(one)];
  return limitedTable(title, ["shot", "element", ...heads], elements, rowOf);
}

function showHeadlines({ elements }) {
  const inState = (state) => elements.filter((one) => one.state === state).length;
  const [done, failed] = [inState("done"), inState("failed")];
  const flagged = elements.filter((one) => one.outside_count > 0).length;
  const seconds = elements.reduce((sum, one) => sum + one.seconds, 0);
  return headlines([
    [String(done), `of ${elements.length}`, "elements are done"],
    [String(failed), "", "failed"],
    [String(elements.length - done - failed), "", "are stale, stopped or not begun"],
    [String(flagged), "", "leave the trained range"],
    [fixedText(seconds / 3600, 2), "h", "that tasks took for what is done"],
  ]);
}

function openElements({ elements }) {
  const open = elements.filter((one) => one.state !== "done");
  return elementTable("Not done", ["state", "why", "host"], open, (one) => [one.state, one.message, one.host]);
}

function contactSheet({ worth_a_look: frames }, { looks }) {
  if (frames.length === 0) return null;
  const figure = (frame, k) => {
    const expected = frame.expected_rms_mm > 0 ? `, ${fixedText(frame.expected_rms_mm, 1)} mm expected` : "";
    const outside = frame.outside > 0 ? `, ${fixedText(frame.outside, 1)} out` : "";
    const label = `${frame.shot}, ${frame.element}, frame ${frame.frame}${expected}${outside}`;
    const picture = looks[k].src ? image(looks[k], label) : null;
    const problem = looks[k].problem ? `: ${looks[k].problem}` : "";
    return element("figure", {}, picture, element("figcaption", {}, label + problem));
  };
  return section(
    "Worth a look",
    paragraph(
      "The frames that the basis is expected to be furthest off in, worst first: by the error that it expects " +
        "(millimetres, root mean square), then by how far they leave the trained range (standard deviations). As they " +
        "stand in the caches.",
    ),
    element("div", { class: "sheet" }, ...frames.map(figure)),
  );
}

function worthSimulating({ simulate_next: next }) {
  if (next.length === 0) return null;
  return section(
    "Worth simulating next",
    paragraph(
      "Simulate these frames into the dataset of the basis, and train it again: bodyopt simulate CHARACTER " +
        "--out DATASET, and the options below.",
    ),
    table(
      ["basis", "frames", "options of simulate"],
      next.map((one) => [one.basis, numberCell(one.frame_count), one.options]),
    ),
  );
}

function flaggedElements({ elements }) {
  const flagged = elements.filter((one) => one.outside_count > 0).sort((a, b) => b.worst_outside - a.worst_outside);
  const heads = ["frames", "standard deviations", "which"];
  return elementTable("Outside the trained range", heads, flagged, (one) => [
    numberCell(one.outside_count, String(one.outside_count)),
    numberCell(one.worst_outside, fixedText(one.worst_outside, 1)),
    one.outside_frames,
  ]);
}

function slowestElements({ elements }) {
  const done = elements.filter((one) => one.frames > 0).sort((a, b) => b.seconds - a.seconds);
  const heads = ["seconds", "frames", "ms a frame", "MiB", "device"];
  return elementTable("Slowest", heads, done, (one) => [
    numberCell(one.seconds, fixedText(one.seconds, 1)),
    numberCell(one.frames, String(one.frames)),
    numberCell((1e3 * one.seconds) / one.frames, fixedText((1e3 * one.seconds) / one.frames, 1)),
    numberCell(one.peak_memory_mib, fixedText(one.peak_memory_mib, 0)),
    one.device,
  ]);
}

function hoursOfElements({ elements }) {
  const names = [...new Set(elements.map((one) => one.element))].sort();
  return limitedTable("Hours of each element", ["element", "shots", "frames", "hours"], names, (name) => {
    const own = elements.filter((one) => one.element === name);
    const sum = (key) => own.reduce((total, one) => total + one[key], 0);
    const hours = sum("seconds") / 3600;
    return [
      name,
      numberCell(own.length, String(own.length)),
      numberCell(sum("frames"), String(sum("frames"))),
      numberCell(hours, fixedText(hours, 4)),
    ];
  });
}

function showKind({ show, tasks, elements }) {
  return {
    title: show,
    subtitle: `What the show has come to: ${plural(tasks, "task")}, ${plural(elements.length, "element")}`,
    sections: Object.entries({
      summary: showHeadlines,
      "what is not done": openElements,
      "frames worth a look": contactSheet,
      "frames worth simulating": worthSimulating,
      "what leaves the trained range": flaggedElements,
      slowest: slowestElements,
      hours: hoursOfElements,
    }),
  };
}
