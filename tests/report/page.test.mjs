// How pages show their figures: the scripts of report/page in a document that knows only what they use.
// Run by: node --test tests/report/page.test.mjs
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import vm from "node:vm";

const folder = new URL("../../report/page/", import.meta.url);
const kept = readFileSync(new URL("report.json", import.meta.url), "utf8");
const scripts = [...readFileSync(new URL("page.html", folder), "utf8").matchAll(/<script src="(.*)">/g)].map(
  ([, name]) => readFileSync(new URL(name, folder), "utf8"),
);

class FakeElement {
  constructor(tag) {
    this.tag = tag;
    this.attributes = {};
    this.children = [];
  }
  setAttribute(name, value) {
    this.attributes[name] = String(value);
  }
  getAttribute(name) {
    return this.attributes[name] ?? null;
  }
  querySelector(tag) {
    return this.all(tag)[0] ?? null;
  }
  append(...children) {
    for (const child of children) this.children.push(child instanceof FakeElement ? child : String(child));
  }
  get textContent() {
    return this.children.map((child) => child.textContent ?? child).join("");
  }
  // All elements in it of this tag.
  all(tag) {
    const inside = this.children.filter((child) => child instanceof FakeElement);
    return inside.flatMap((child) => [...(child.tag === tag ? [child] : []), ...child.all(tag)]);
  }
  // Of a canvas: what is painted where.
  get width() {
    return Number(this.attributes.width);
  }
  getContext() {
    this.painted = [];
    return { fillRect: (...area) => this.painted.push(area) };
  }
  toDataURL() {
    return JSON.stringify(this.painted);
  }
}

const palette = Array.from({ length: 64 }, (_, i) => `#0000${i.toString(16).padStart(2, "0")}`);

// The scripts after they have shown a page, and its elements.
function shown(kind, figures, pictures) {
  const page = new FakeElement("main");
  const contents = new FakeElement("script");
  contents.append(JSON.stringify({ kind, figures, pictures, heat_colours: palette }));
  const document = {
    createElement: (tag) => new FakeElement(tag),
    createElementNS: (space, tag) => new FakeElement(tag),
    getElementById: (id) => ({ page, contents })[id],
  };
  const context = vm.createContext({ document, JSON });
  for (const script of scripts) vm.runInContext(script, context);
  return { page, text: page.textContent, run: (code) => vm.runInContext(code, context), document };
}

const picture = { src: "data:image/png;base64,Zg==", width: 6, height: 2 };

function reportPictures() {
  return {
    frames: [picture, picture, picture, picture],
    mean_error: picture,
    flexed: picture,
    sections: picture,
    regions: picture,
    jiggle: { animation: picture, slow: picture, strip: picture },
  };
}

// A report of the figures that tests/report/report_test.cpp writes, with changes.
function report(change = () => {}) {
  const figures = JSON.parse(kept);
  const pictures = reportPictures();
  change(figures, pictures);
  return shown("report", figures, pictures);
}

function rowsOf(page) {
  return page.all("tr").map((row) => row.children.map((cell) => cell.textContent).join("|"));
}

function pathsOf(svg) {
  return svg.all("path").map((path) => path.attributes.d);
}

test("everything of a report is shown", () => {
  const { page, text } = report();
  const heads = page.all("h2").map((head) => head.textContent);
  assert.deepEqual(heads, [
    "What now",
    "Warnings of the data",
    "On motion that shares nothing with what was trained on",
    "Held-out poses: truth, Direct Delta Mush, result, and where it differs",
    "The methods, on the held-out frames",
    "Error of every held-out frame",
    "Jiggle",
    "Regions of the skin",
    "What the muscles explain",
    "What flexing does",
    "What lies inside",
    "Expected errors: what the basis does not know",
    "Bytes against millimetres",
    "What is left to learn",
    "Details",
    "To repeat it",
  ]);
  const links = page.all("nav")[0].all("a");
  assert.deepEqual(
    links.map((link) => link.textContent),
    heads,
  );
  assert.equal(links[1].getAttribute("href"), "#warnings");
  assert.equal(page.all("img").length, 11);
  assert.equal(page.all("path").length, 4 + 4 + 2 + 2 + 1);
  assert.ok(!/NaN|undefined|null|There is nothing|cannot be/.test(text), text);
});

test("takes are told by area and part, those that gained least first", () => {
  const rows = rowsOf(report().page);
  const shot = rows.findIndex((row) => row.startsWith("shot|3|3750|4|2|0.5|2.5|0.75"));
  assert.ok(shot > 0);
  assert.ok(rows[shot + 1].startsWith("\u2003knee|"));
  assert.ok(rows[shot + 2].startsWith("\u2003hip|"));
  assert.ok(rows.some((row) => row.startsWith("rom (between trained frames)|2|")));
  const between = report((figures) => figures.takes.pop());
  assert.match(between.text, /not how a shot will look/);
});

test("the page says what would help", () => {
  const { page, text } = report();
  assert.match(text, /The skin at hip moves 12 mm, of which nothing explains 2 mm: a muscle there may help\./);
  assert.doesNotMatch(text, /The skin at knee/);
  assert.doesNotMatch(text, /The skin at toe/); // much of its motion, but less than the whole skin keeps
  assert.match(text, /no region listens to them \(1\): plantaris\./);
  assert.match(text, /Simulate poses like those of take 'shot': 3, 13:/);
  assert.equal(page.all("code")[0].textContent, 'bodyopt view BASIS data --do "frame shot 11; heat on"');
  assert.match(text, /Look at the muscles around hip: 2 mm there/);
  assert.match(text, /rank alike with Spearman's rho 0\.875/);
  assert.match(text, /control 'breath' is 0 in every training frame/);
  assert.ok(rowsOf(page).includes("2. knee|3|0.25|-|0.125"));
  assert.ok(rowsOf(page).includes("264|0.625|135|3100"));
});

test("frames worth simulating are listed by take", () => {
  const axis = {
    frames: [1, 2, 3, 1, 2],
    takes: [
      { name: "rom", first_index: 0 },
      { name: "walk", first_index: 3 },
    ],
  };
  const { run } = report();
  assert.equal(run(`frameList(${JSON.stringify(axis)}, [4, 0, 2])`), "take 'rom': 1, 3; take 'walk': 2");
  assert.equal(run(`frameList({ frames: [7, 8], takes: [] }, [1, 0])`), "7, 8");
});

test("Direct Delta Mush is beside the result, and flexing is shown", () => {
  const { page, text } = report();
  const labels = page.all("div").filter((div) => div.attributes.class === "columns");
  const four = labels.filter((div) => div.textContent === "truthDirect Delta MushBodyopt (result)distance");
  assert.equal(four.length, 4);
  assert.ok(labels.some((div) => div.textContent === "at restflexedwhat flexing moves"));
  assert.match(text, /frame 21 of take 'flexed'/);
  assert.match(text, /moves it most, by 6\.5 mm: biceps 1, triceps 0\.25\./);
  const many = report((figures) => {
    for (const name of ["a", "b", "c", "d", "e"]) figures.flexed.controls[name] = 0.11;
  });
  assert.match(many.text, /d 0\.11 and 1 control more\./);
});

test("sections are named by their numbers, at rest and flexed beside each other", () => {
  const { page, text } = report();
  const labels = page.all("div").filter((div) => div.attributes.class === "columns");
  assert.ok(labels.some((div) => div.textContent === "at restflexedat restflexed"));
  assert.match(text, /in frame 21 of take 'flexed'.*1 thigh, 2 upper arm\. Bone ivory/);
  const without = report((figures) => delete figures.sections);
  assert.doesNotMatch(without.text, /Bone ivory/);
});

test("without held-out frames nothing is measured, and the page says so", () => {
  const { text } = report((figures, pictures) => {
    Object.assign(figures, { methods: [], heldout: { frames: [], takes: [] }, pictures: [], takes: [] });
    figures.dataset = { ...figures.dataset, heldout_frames: 0, how_to_hold_out: "say --heldout" };
    for (const name of ["coverage", "mean_error", "flexed", "sections", "jiggle", "simulation"]) delete figures[name];
    for (const name of Object.keys(pictures)) delete pictures[name];
  });
  assert.match(text, /holds out no frames.*are missing: say --heldout\./);
  assert.match(text, /The skin at hip/);
  assert.match(text, /this basis, expected: 0\.6 mm/);
  assert.doesNotMatch(text, /held out: /);
  assert.doesNotMatch(text, /need a Vulkan device/);
  assert.match(text, /Not in this report, for want of figures: takes, pictures, methods, curves, jiggle, flexing, sections, coverage\./);
});

test("without a device the page says so", () => {
  const { page, text } = report((figures, pictures) => {
    figures.pictures = [];
    delete figures.mean_error;
    for (const name of Object.keys(pictures)) delete pictures[name];
  });
  assert.match(text, /need a Vulkan device/);
  assert.equal(page.all("img").length, 0);
  assert.match(text, /How far the jiggling skin is/);
});

// 8 mm at the stop; below 0.8 mm from frame 6 on, three frames later: frame 4 does not count, frame 5 is above again.
test("the page says how flesh swings", () => {
  const { text } = report();
  assert.match(text, /up to 8 mm from where it would be at rest in its pose, in frame 3; from frame 6 on, 0\.13 s/);
  assert.match(text, /A frame on A device: diffuse 0\.5 ms, jiggle 6\.25 ms\./);
  assert.match(text, /In 2 of the frames some are turned inside out, 5 at most\./);
  const still = report(({ jiggle }) => {
    jiggle.frame_inverted_tets.fill(0);
    jiggle.diffuse_ms = jiggle.jiggle_ms = 0;
    jiggle.frame_max_mm[6] = 3;
  });
  assert.match(still.text, /it is still moving when the clip ends/);
  assert.match(still.text, /Computed on A device, which tells no times\./);
  assert.match(still.text, /None of them is turned inside out\./);
});

test("the draft is told with the simulation alone", () => {
  const draft = "draft of the held-out motion|in 7 s, 3.5 mm RMS from the simulation, 20 mm at most";
  assert.ok(rowsOf(report().page).includes(draft));
  assert.doesNotMatch(report((figures) => delete figures.simulation).text, /draft/);
});

test("methods are compared honestly", () => {
  const { page, text } = report();
  assert.match(text, /5 held-out frames/);
  assert.match(text, /8timessmaller RMS error than DDM alone \(4 mm\)/);
  assert.match(text, /2timessmaller RMS error than linear/);
  const worse = report((figures) => (figures.methods.at(-1).errors_mm.rms = 2));
  assert.match(worse.text, /2timeslarger RMS error than linear/);
  const best = page.all("td").filter((cell) => cell.attributes.class === "number best");
  assert.deepEqual(
    best.map((cell) => cell.textContent),
    ["0.5", "1.5", "4.5", "0.05"],
  );
});

test("names that are markup are text", () => {
  const hostile = "<img src=x onerror=alert(1)>";
  const { page, text, document } = report((figures) => {
    figures.character.name = figures.regions[0].name = figures.methods[0].name = hostile;
    figures.heldout.takes = [
      { name: hostile, first_index: 0 },
      { name: "b", first_index: 2 },
    ];
  });
  assert.equal(document.title, `How the skin of ${hostile} moves`);
  assert.ok(text.includes(`1. ${hostile}`));
  assert.equal(page.all("img").length, 11);
  for (const image of page.all("img")) assert.ok(image.attributes.src.startsWith("data:image/"));
});

test("figures that are not there spoil no other section", () => {
  const { page, text } = report((figures) => {
    delete figures.takes;
    figures.methods[0].errors_mm.p99 = null;
    figures.methods[0].frame_rms_mm[1] = null;
  });
  assert.match(text, /The section "takes" cannot be shown/);
  assert.match(text, /To repeat it/);
  assert.doesNotMatch(text, /NaN|null/);
  assert.ok(!page.all("tr").some((row) => /LBS.*best/.test(JSON.stringify(row))));
  assert.match(shown("new", {}, {}).text, /The figures of this page cannot be read/);
});

test("a line is broken where frames or values are missing", () => {
  const { run } = report();
  const path = (values) =>
    run(`pathsOfPlot = linePlot("frame", "mm", { frames: [1, 3, 5, 11, 13], takes: [] },
    [{ label: "a", colour: "#fff", y: ${values} }])`);
  const [whole] = pathsOf(path("[1, 2, 1, 4, 0]"));
  assert.equal(whole.match(/M/g).length, 2);
  assert.equal(whole.match(/L/g).length, 3);
  const [broken] = pathsOf(path("[1, null, 1, 4, 0]"));
  assert.equal(broken.match(/M/g).length, 3);
  assert.equal(broken.match(/h0/g).length, 2);
});

// A take of every tenth frame is one curve beside a take of every frame; a frame by itself is a dot.
test("every take has its own step", () => {
  const { run } = report();
  const takes = `[{ name: "rom", first_index: 0 }, { name: "flexed", first_index: 3 }]`;
  const axis = `{ frames: [1, 2, 3, 1, 11, 21, 51], takes: ${takes} }`;
  assert.equal(run(`gaps(${axis}).join()`), "true,false,false,true,false,false,true");
  const svg = run(`linePlot("frame", "mm", ${axis}, [{ label: "a", colour: "#fff", y: [1, 2, 1, 4, 1, 2, 3] }])`);
  assert.equal(pathsOf(svg)[0].match(/h0/g).length, 1);
  assert.match(svg.textContent, /flexed/);
});

test("larger errors are drawn higher, on a logarithmic scale", () => {
  const svg = report().run(`linePlot("frame", "mm", { frames: [1, 2, 3], takes: [] },
    [{ label: "a", colour: "#fff", y: [0.1, 1, 10] }])`);
  const places = pathsOf(svg)[0]
    .slice(1)
    .split("L")
    .map((place) => place.split(" ").map(Number));
  assert.ok(places[0][0] < places[1][0] && places[1][0] < places[2][0]);
  assert.ok(places[0][1] - places[1][1] > 40);
  assert.ok(Math.abs(places[0][1] - 2 * places[1][1] + places[2][1]) < 0.3);
});

test("nothing at all and all zeros are drawn", () => {
  const { run } = report();
  for (const plot of [
    `linePlot("frame", "mm", { frames: [], takes: [] }, [])`,
    `linePlot("frame", "mm", { frames: [1], takes: [] }, [{ label: "a", colour: "#fff", y: [0] }])`,
    `barChart([])`,
    `barChart([{ label: "a", colour: "#fff", value: 0, text: "0 mm" }])`,
  ]) {
    assert.doesNotMatch(JSON.stringify(run(plot)), /NaN|Infinity/);
  }
});

test("the trade-off marks the basis where it lies", () => {
  const point = (bytes, mm) => `{ bytes_per_vertex: ${bytes}, expected_rms_mm: ${mm} }`;
  const svg = report().run(`tradeOffPlot([${point(100, 8)}, ${point(200, 4)}, ${point(300, 2)}], ${point(200, 4)}, 5)`);
  const centres = (radius) =>
    svg
      .all("circle")
      .filter((c) => c.attributes.r === radius)
      .map((c) => [Number(c.attributes.cx), Number(c.attributes.cy)]);
  const [points, marks] = [centres("3"), centres("6.5")];
  assert.deepEqual(marks[0], points[1]); // the chosen one is the second of the curve
  assert.equal(marks[1][0], marks[0][0]); // as many bytes
  assert.ok(marks[1][1] < marks[0][1]);
  assert.ok(points[0][0] < points[2][0]);
  assert.match(svg.textContent, /this basis, expected: 4 mm/);
  assert.match(svg.textContent, /held out: 5 mm/);
});

// More frames than pixels: the worst of those that share a column is seen, whichever it is.
test("the heat strip has a row per region, a scale, and hides no frame", () => {
  const { run } = report();
  const axis = `{ frames: [10, 11, 12], takes: [] }`;
  const strip = run(`heatStrip(${axis}, [0.5, 0.25, 0.75], ["elbow", "a & b"], [[1, 2], [3, 1], [0, 3.1]])`);
  const texts = strip.all("text").map((text) => text.textContent);
  for (const text of ["whole skin", "elbow", "a & b", "10", "11", "12", "3.2 mm", "0.8"])
    assert.ok(texts.includes(text));
  assert.equal(JSON.parse(strip.all("image")[0].attributes.href).length, 9);
  for (const bad of [999, 1000, 1001]) {
    const frames = `Array.from({ length: 2000 }, (_, k) => k)`;
    const long = run(
      `heatStrip({ frames: ${frames}, takes: [] }, ${frames}.map((k) => k === ${bad} ? 1.2 : 1), [], [])`,
    );
    assert.match(long.textContent, /1\.2 mm/);
  }
});

test("the colour bar has the colours of the pictures", () => {
  const svg = report().run("colourBar(2)");
  assert.deepEqual(
    svg.all("rect").map((rect) => rect.attributes.fill),
    palette,
  );
  assert.deepEqual(
    svg.all("text").map((text) => text.textContent),
    ["0", "0.5", "1", "1.5", "2 mm"],
  );
});

test("numbers are short", () => {
  const { run } = report();
  const texts = { 0.5: "0.5", 0: "0", 12.3456: "12.3", 123456: "123000", 0.00002: "2e-5", null: "-", NaN: "-" };
  for (const [number, text] of Object.entries(texts)) assert.equal(run(`numberText(${number})`), text);
  assert.equal(run("numberText(1002, 9)"), "1002");
  assert.equal(run("secondsText(89.5)"), "89.5 s");
  assert.equal(run("secondsText(150)"), "2 min 30 s");
  assert.equal(run("[1.25, 0.996, 1].map(changeText).join()"), "+25.0 %,-0.4 %,+0.0 %");
  assert.equal(run("[3.3, 0.02, 0.051].map((value) => numberText(roundUp(value))).join()"), "5,0.02,0.1");
  assert.equal(run("[1.7, 0.31, 8.1, 0].map((value) => numberText(heatScale(value))).join()"), "2,0.32,10,1");
});

test("tables mark the best and align numbers", () => {
  const table = report().run(`table(["name", "error", "size"],
    [["x", numberCell(2), numberCell(7)], ["y", numberCell(1), numberCell(9)]], ["error"])`);
  assert.deepEqual(
    table.all("td").map((cell) => cell.attributes.class),
    ["number", "number", "number best", "number"],
  );
  assert.deepEqual(
    table.all("th").map((cell) => cell.textContent),
    ["name", "error", "size", "x", "y"],
  );
});

function showFigures() {
  const element = (state, seconds, outside) => ({
    ...{ shot: "sq010", element: "hero", state, seconds, message: "", host: "", device: "cpu", frames: 10 },
    ...{ outside_count: outside, outside_frames: "1", worst_outside: outside, peak_memory_mib: 100 },
  });
  const elements = [
    element("done", 3600, 0),
    element("done", 1800, 2),
    element("done", 0, 0),
    element("failed", 0, 0),
    element("failed", 0, 1),
    element("stale", 360, 1),
    element("stopped", 0, 0),
    element("missing", 0, 0),
    element("missing", 0, 2),
    element("missing", 0, 0),
  ];
  Object.assign(elements[3], { message: "no <memory>", host: "node7" });
  return { show: "the show", tasks: 3, elements, worth_a_look: [], simulate_next: [] };
}

test("a show's headlines count the elements by their state", () => {
  const { page, text } = shown("show", showFigures(), { looks: [] });
  for (const headline of [
    "3of 10elements are done",
    "2failed",
    "5are stale, stopped or not begun",
    "4leave the trained range",
    "1.60hthat tasks took for what is done",
  ]) {
    assert.ok(
      page.all("div").some((div) => div.textContent === headline),
      headline,
    );
  }
  assert.match(text, /What the show has come to: 3 tasks, 10 elements/);
  assert.ok(rowsOf(page).includes("sq010|hero|failed|no <memory>|node7"));
  assert.ok(rowsOf(page).includes("hero|10|100|1.6000"));
  assert.ok(rowsOf(page).includes("sq010|hero|3600.0|10|360000.0|100|cpu"));
});

test("a show's frames worth a look are pictures, or say why there is none", () => {
  const figures = showFigures();
  const frame = { shot: "a<b>", element: "hero", frame: 7, expected_rms_mm: 1.25, outside: 2 };
  figures.worth_a_look = [frame, { ...frame, expected_rms_mm: 0 }];
  figures.simulate_next = [{ basis: "hero.safetensors", frame_count: 2, options: "--clip 'a b' --frames 1,7" }];
  figures.elements = Array.from({ length: 30 }, () => figures.elements[3]);
  const { page, text } = shown("show", figures, { looks: [picture, { problem: "the cache is gone" }] });
  assert.deepEqual(
    page.all("img").map((one) => one.attributes.alt),
    ["a<b>, hero, frame 7, 1.3 mm expected, 2.0 out"],
  );
  assert.match(text, /a<b>, hero, frame 7, 2\.0 out: the cache is gone/);
  assert.ok(rowsOf(page).includes("hero.safetensors|2|--clip 'a b' --frames 1,7"));
  assert.match(text, /5 more are in the JSON/);
});

test("a transfer tells of every target", () => {
  const part = { joint: "hip", vertices: 7, confidence: 0.5, size: 2, unevenness: 0.25, breaks_assumption: true };
  const pose = { frame: 1, is_shown: true, source_volume: 1.01, target_volume: 0.98, expected_rms_mm: 1.5 };
  const target = {
    ...{
      target: "man.glb",
      likeness: 0.75,
      least_likeness: 0.36,
      confidence: 0.5,
      same_topology: false,
      size_ratio: 1.5,
    },
    ...{ filled_in_vertices: 3, vertices: 9, worth_simulating: "1,5", parts: [part] },
    poses: [pose, { ...pose, frame: 2, is_shown: false }],
  };
  const failed = { target: "stranger.glb", error: "no joints in common" };
  const alone = { ...target, poses: [], worth_simulating: "" };
  const figures = { title: "Transfer", subtitle: "to others", targets: [target, failed, alone] };
  const { page, text } = shown("transfer", figures, [{ match: picture, poses: picture }, {}, { match: picture }]);
  assert.deepEqual(
    page.all("h2").map((head) => head.textContent),
    ["man.glb", "stranger.glb", "man.glb"],
  );
  assert.ok(rowsOf(page).includes("hip|7|0.50|2.00|25 %|another anatomy: a guess"));
  assert.ok(rowsOf(page).includes("1|+1.0 %|-2.0 %|1.50"));
  assert.equal(page.all("img").length, 3);
  assert.match(text, /3of 9vertices are filled in/);
  assert.equal(text.match(/--frames 1,5/g).length, 1);
  assert.match(text, /no joints in common/);
  assert.doesNotMatch(text, /NaN|undefined|cannot be/);
});
