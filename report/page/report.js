"use strict";
// The page of a trained character, from what report.json holds. A section without figures is null.

// Of the linear correctives, that with the smallest error; undefined where there are none.
function bestLinear(figures) {
  const linear = figures.methods.filter((method) => method.name.includes(", linear"));
  return linear.sort((a, b) => a.errors_mm.rms - b.errors_mm.rms)[0];
}

function learnedOf(figures) {
  return figures.methods.at(-1);
}

function colourOfMethod(figures, method) {
  if (method === learnedOf(figures)) return colours.learned;
  if (method === figures.methods[0]) return colours.lbs;
  if (method === figures.methods[1]) return colours.ddm;
  return method === bestLinear(figures) ? colours.linear : colours.other;
}

// How much smaller (or larger) the error of what was learned is than another method's.
function comparedWith(figures, other, name) {
  const [own, others] = [learnedOf(figures).errors_mm.rms, other.errors_mm.rms];
  if (!(own > 0)) return ["0", "mm", `of error, where ${name} has ${millimetres(others)}`];
  const ratio = others >= own ? others / own : own / Math.max(others, 1e-12);
  const smaller = others >= own ? "smaller" : "larger";
  return [numberText(ratio, ratio < 2 ? 3 : 2), "times", `${smaller} RMS error than ${name} (${millimetres(others)})`];
}

function reportHeadlines(figures) {
  const bytes = [numberText(figures.bytes_per_vertex), "bytes", "per vertex, all tables that run"];
  if (figures.methods.length === 0) {
    const meaning = "RMS error that cross-validation expects of poses like the training frames";
    return headlines([[numberText(figures.expected_rms_mm), "mm", meaning], bytes]);
  }
  const errors = learnedOf(figures).errors_mm;
  const list = [
    [
      numberText(errors.rms),
      "mm",
      "RMS error on the held-out frames; " +
        `99 % of the points within ${millimetres(errors.p99)}, the worst ${millimetres(errors.max)}`,
    ],
    comparedWith(figures, figures.methods[1], "DDM alone"),
  ];
  const linear = bestLinear(figures);
  if (linear) list.push(comparedWith(figures, linear, "linear correctives of equal size"));
  return headlines([...list, bytes]);
}

function summarySection(figures) {
  const { character, dataset } = figures;
  const muscles = character.muscles > 0 ? `, with ${plural(character.muscles, "muscle")},` : "";
  const measured =
    figures.methods.length === 0
      ? "The dataset holds out no frames, so nothing here is measured on motion that was not trained on: errors, " +
        `pictures and the expected errors of held-out frames are missing: ${dataset.how_to_hold_out}.`
      : `It was then given ${plural(dataset.heldout_frames, "frame")} that it had not seen. The errors on this page ` +
        "are measured on these held-out frames, against their true shapes, after the root's translation is taken " +
        "out; where a figure is of the training frames, it says so.";
  const quick = "This is a quick run on a few of the frames: it shows that everything works, not how well.";
  return element(
    "section",
    {},
    paragraph(
      `Bodyopt learned from ${plural(dataset.train_frames, "frame")} what the skin of this character${muscles} ` +
        "does beyond Direct Delta Mush (DDM).",
    ),
    paragraph(measured),
    figures.quick ? paragraph(quick) : null,
    reportHeadlines(figures),
  );
}

// How `bodyopt view` opens a frame of the dataset beside its truth.
function viewCommand(figures, { take, frame }) {
  const dataset = figures.provenance.files.find((file) => file.what === "dataset")?.path ?? "DATASET";
  return `bodyopt view BASIS ${dataset.replace(/\/dataset\.json$/, "")} --do "frame ${take} ${frame}; heat on"`;
}

function nowSection(figures) {
  const { dataset, coverage, heldout } = figures;
  const items = [];
  if (figures.quick) items.push(["Train again without --quick: this says that it works, not how well."]);
  if (figures.methods.length === 0) items.push([`Hold out frames, to measure: ${dataset.how_to_hold_out}.`]);
  if (figures.warnings.length > 0) items.push(["Read the ", element("a", { href: "#warnings" }, "warnings"), " below."]);
  const worst = figures.pictures.find((told) => told.kind === "worst");
  if (worst) {
    const command = element("code", {}, viewCommand(figures, worst));
    items.push([`Look at the frame that is worst, ${millimetres(worst.rms_mm)} RMS: `, command]);
  }
  for (const { name, validation_rms_mm: left } of unexplained(figures).slice(0, 1)) {
    items.push([`Look at the muscles around ${name}: ${millimetres(left)} there are explained by nothing.`]);
  }
  if (coverage) {
    const frames = frameList(heldout, coverage.worth_simulating_index);
    items.push([`Simulate poses like those of ${frames}: they would teach most. bodyopt coverage lists a shot's.`]);
  }
  if (items.length === 0) return null;
  return section("What now", element("ul", {}, ...items.map((item) => element("li", {}, ...item))));
}

function warningsSection(figures) {
  if (figures.warnings.length === 0) return null;
  return section("Warnings of the data", ...figures.warnings.map(paragraph));
}

// Of Direct Delta Mush's error, how much is left.
function ratioOf(errors) {
  return errors.ddm_mm > 0 ? errors.full_mm / errors.ddm_mm : 0;
}

function takeRows(take) {
  const row = (name, errors, frames, area, rho) => [
    name,
    frames,
    numberCell(1e4 * area),
    ...[errors.ddm_mm, errors.full_mm, ratioOf(errors), errors.expected_mm].map((value) => numberCell(value)),
    rho,
  ];
  const area = take.parts.reduce((sum, part) => sum + part.area_m2, 0);
  const name = take.take + (take.foreign ? "" : " (between trained frames)");
  const rho = take.rank_correlation === null ? "" : numberCell(take.rank_correlation);
  const parts = [...take.parts].sort((a, b) => ratioOf(b) - ratioOf(a));
  return [
    row(name, take, numberCell(take.frames), area, rho),
    ...parts.map((part) => row(`\u2003${part.part}`, part, "", part.area_m2, "")),
  ];
}

function takesSection(figures) {
  const { takes } = figures;
  if (takes.length === 0) return null;
  const isForeign = takes.some((take) => take.foreign);
  const heads = ["take and part", "frames", "area, cm\u00b2", "DDM, mm", "learned, mm", "of DDM's error"];
  const between =
    "All held-out frames are of takes that were trained on: this says how well poses are interpolated, not how a " +
    "shot will look. Hold out a whole take of a shot to see that.";
  return section(
    isForeign ? "On motion that shares nothing with what was trained on" : "Between the frames trained on",
    table([...heads, "expected, mm", "rho"], takes.flatMap(takeRows)),
    paragraph(
      "RMS over the held-out frames by area of the skin, so that fine meshes of head and hands do not count for more " +
        "than they cover; below each take the skin of every joint, those that gained least first. Expected is what " +
        "the basis says of itself without the truth, rho how alike it ranks frames and parts with it (Spearman).",
    ),
    isForeign ? null : paragraph(between),
  );
}

const pictureTitles = { worst: "The worst", median: "The median" };
const frontAndBack = ["from the front", "from behind"];

function heldoutPicture(figures, told, picture) {
  const ofTake = figures.heldout.takes.length > 1 ? ` of take '${told.take}'` : "";
  const title = `${pictureTitles[told.kind] ?? "A chosen pose"}: held-out frame ${told.frame}${ofTake}`;
  const words = told.caption === "" ? "" : `: ${told.caption}`;
  const caption = `RMS ${millimetres(told.rms_mm)}, largest ${millimetres(told.max_mm)}${words}.`;
  const labels = ["truth", "Direct Delta Mush", "Bodyopt (result)", "distance"];
  return pictureFigure(picture, labels, title, caption, colourBar(told.heat_scale_mm));
}

function meanErrorPicture(figures, picture) {
  const { largest_mm: largest, heat_scale_mm: scaleMm } = figures.mean_error;
  const frames = plural(figures.heldout.frames.length, "held-out frame");
  const caption =
    `On the rest skin: where it is wrong, on average over ${frames}; ` + `${millimetres(largest)} at the worst point.`;
  const title = "Mean error of every point over the held-out frames";
  return pictureFigure(picture, frontAndBack, title, caption, colourBar(scaleMm));
}

function picturesSection(figures, pictures) {
  if (figures.methods.length === 0) return null;
  const title = "Held-out poses: truth, Direct Delta Mush, result, and where it differs";
  if (figures.pictures.length === 0) {
    const why = "There are no pictures: they need a Vulkan device, and none was found (or the CPU was asked for).";
    return section(title, paragraph(why));
  }
  return section(
    title,
    paragraph(
      "From left to right: the true shape, Direct Delta Mush alone, the learned skin, and the learned skin coloured " +
        "by its distance from the truth: clay where they agree, dark magenta where they are as far apart as the " +
        "colour bar says or more.",
    ),
    ...figures.pictures.map((told, k) => heldoutPicture(figures, told, pictures.frames[k])),
    figures.mean_error ? meanErrorPicture(figures, pictures.mean_error) : null,
  );
}

function methodRow(method) {
  const { rms, p99, max, jitter } = method.errors_mm;
  const numbers = [rms, p99, max, jitter, method.bytes_per_vertex, method.coefficients, method.seconds];
  return [method.name, ...numbers.map((value) => numberCell(value))];
}

function methodsSection(figures) {
  const { methods } = figures;
  if (methods.length === 0) return null;
  const errors = ["RMS, mm", "99th percentile, mm", "largest, mm", "jitter, mm"];
  const bars = methods.map((method) => {
    const { rms } = method.errors_mm;
    return { label: method.name, colour: colourOfMethod(figures, method), value: rms, text: millimetres(rms) };
  });
  const others =
    "The others were trained on the same frames and may have as many bytes as the last: what they un-pose with, what " +
    "drives them (joints, or joints and muscle strains), by linear maps or kernels, and where: dense (the whole skin " +
    "together), local or static (regions by skin weights), dynamic (regions by what muscles do, too). LBS with linear " +
    "maps of joints is what SMPL (dense) and STAR (local) do, with kernels what the deformers of animation packages do.";
  return section(
    "The methods, on the held-out frames",
    chart(barChart(bars), "RMS error over all held-out frames. Shorter is better."),
    table(["method", ...errors, "bytes per vertex", "coefficients", "training, s"], methods.map(methodRow), errors),
    paragraph(
      "LBS is linear blend skinning, where every rig starts; DDM is Direct Delta Mush, smooth skinning from the same " +
        "weights. Neither learns. Jitter is the RMS second difference of the error over consecutive held-out frames: " +
        "what is seen as popping. The best value of each column of errors is highlighted. Nothing was tuned on the " +
        "held-out frames.",
    ),
    methods.length > 3 ? paragraph(others) : null,
  );
}

function curvesSection(figures) {
  const { methods } = figures;
  if (methods.length === 0) return null;
  const shown = methods.filter((method, k) => k < 2 || method === learnedOf(figures) || method === bestLinear(figures));
  const curves = (label, key) => {
    const series = shown.map((method) => ({
      label: method.name,
      colour: colourOfMethod(figures, method),
      y: method[key],
      isEmphasised: method === learnedOf(figures),
    }));
    return linePlot("held-out frame", label, figures.heldout, series);
  };
  return section(
    "Error of every held-out frame",
    chart(
      curves("RMS error, mm", "frame_rms_mm"),
      "RMS over all vertices of each held-out frame, in millimetres, on a logarithmic scale.",
    ),
    chart(
      curves("largest error, mm", "frame_max_mm"),
      "The worst vertex of each held-out frame, in millimetres, on a logarithmic scale.",
    ),
  );
}

function flipBook(jiggle, pictures) {
  const labels = ["static", "jiggling"];
  return [
    pictureFigure(pictures.animation, labels, "An arm that stops suddenly", "All frames of the motion, in time."),
    pictureFigure(pictures.slow, labels, "The same at half the speed", "All frames, each twice as long."),
    pictureFigure(
      pictures.strip,
      jiggle.strip_frames.map((frame) => `frame ${frame}`),
      "Around the stop",
      "Static above; jiggling below, coloured by the distance from the static skin. The pose is held from frame " +
        `${jiggle.stops} on.`,
      colourBar(jiggle.heat_scale_mm),
    ),
  ];
}

// When the largest displacement is reached, and from which frame on it stays below a tenth of that.
function swingText(jiggle) {
  const peak = largestOf(jiggle.frame_max_mm);
  const text =
    `The skin is up to ${millimetres(peak)} from where it would be at rest in its pose, ` +
    `in frame ${jiggle.frames[jiggle.frame_max_mm.indexOf(peak)]}; `;
  const settled = 1 + jiggle.frame_max_mm.findLastIndex((mm) => mm >= 0.1 * peak);
  if (settled === jiggle.frames.length) return `${text}it is still moving when the clip ends.`;
  const seconds = (jiggle.frames[settled] - jiggle.stops) / jiggle.frames_per_second;
  const after = `${numberText(seconds, 2)} s after the stop, less than a tenth of that is left.`;
  return `${text}from frame ${jiggle.frames[settled]} on, ${after}`;
}

function fleshText(jiggle) {
  const turned = jiggle.frame_inverted_tets.filter((count) => count > 0);
  const inverted =
    turned.length === 0
      ? "None of them is turned inside out."
      : `In ${turned.length} of the frames some are turned inside out, ${largestOf(turned)} at most.`;
  const [diffuse, own] = [numberText(jiggle.diffuse_ms), numberText(jiggle.jiggle_ms)];
  const time =
    jiggle.diffuse_ms === 0 && jiggle.jiggle_ms === 0
      ? `Computed on ${jiggle.device}, which tells no times.`
      : `A frame on ${jiggle.device}: diffuse ${diffuse} ms, jiggle ${own} ms.`;
  return (
    `The flesh is ${jiggle.tets} tetrahedra of ${jiggle.nodes} nodes, quality ${numberText(jiggle.worst_quality, 2)} ` +
    `at worst (1: regular). ${inverted} Tables: diffuse ${numberText(jiggle.diffuse_mb)} MB, ` +
    `jiggle ${numberText(jiggle.jiggle_mb)} MB. ${time}`
  );
}

function jiggleSection(figures, pictures) {
  const { jiggle } = figures;
  if (!jiggle) return null;
  const curves = [
    { label: "largest", colour: colours.learned, y: jiggle.frame_max_mm, isEmphasised: true },
    { label: "RMS", colour: colours.ddm, y: jiggle.frame_rms_mm },
  ];
  return section(
    "Jiggle",
    paragraph(
      "Flesh has inertia: it lags while the arm is swung up, and swings on when the arm stops dead. A linear " +
        "finite-element step on the quasi-static skin adds that; a pose that is held adds nothing.",
    ),
    ...(pictures.jiggle ? flipBook(jiggle, pictures.jiggle) : []),
    chart(
      linePlot("frame", "displacement, mm", { frames: jiggle.frames, takes: [] }, curves),
      "How far the jiggling skin is from the static one in every frame of the motion.",
    ),
    paragraph(swingText(jiggle)),
    paragraph(fleshText(jiggle)),
  );
}

// Regions that keep much more than the skin as a whole, and a notable part of their own motion; worst first.
function unexplained(figures) {
  const isMuch = ({ validation_rms_mm: left, moves_rms_mm: moves }) =>
    left >= 1.5 * figures.expected_rms_mm && left >= 0.05 * moves;
  return figures.regions
    .filter(isMuch)
    .sort((a, b) => b.validation_rms_mm - a.validation_rms_mm)
    .slice(0, 5);
}

function regionsSection(figures, pictures) {
  const { regions, coverage } = figures;
  if (regions.length === 0) return null;
  const orDash = (value) => (value === null ? "-" : numberCell(value));
  const heldout = (region) => [orDash(region.heldout_expected_rms_mm), orDash(region.heldout_true_rms_mm)];
  const rows = regions.map((region, k) => [
    `${k + 1}. ${region.name}`,
    numberCell(region.moves_rms_mm),
    numberCell(region.validation_rms_mm),
    ...(coverage ? heldout(region) : []),
  ]);
  const heads = ["region", "moves, mm", "left by cross-validation, mm"];
  if (coverage) heads.push("expected on held-out frames, mm", "true on held-out frames, mm");
  const title = "The regions in which the skin is learned";
  return section(
    "Regions of the skin",
    pictures.regions ? pictureFigure(pictures.regions, frontAndBack, title, "Numbered as below.") : null,
    table(heads, rows),
    paragraph(
      "RMS over the vertices of a region: how far it moves beyond Direct Delta Mush in the training frames, and how " +
        "much of that stays unexplained in frames that cross-validation held out. A dash: the basis keeps nothing of " +
        "the region, because it is not worth its bytes.",
    ),
    ...unexplained(figures).map((region) => {
      const [moves, left] = [millimetres(region.moves_rms_mm), millimetres(region.validation_rms_mm)];
      const text = `The skin at ${region.name} moves ${moves}, of which nothing explains ${left}: `;
      return paragraph(`${text}a muscle there may help.`);
    }),
  );
}

function musclesSection(figures) {
  const { muscles } = figures;
  if (muscles.length === 0) return null;
  const useful = muscles.filter((muscle) => muscle.explains_percent > 0);
  const useless = muscles.filter((muscle) => !(muscle.explains_percent > 0)).map((muscle) => muscle.name);
  const bars = useful.slice(0, 20).map(({ name: label, explains_percent: value }) => {
    return { label, colour: colours.heldout, value, text: `${numberText(value)} %` };
  });
  const more = useful.length - bars.length;
  const names = `Of no use to the basis, no region listens to them (${useless.length}): ${useless.join(", ")}.`;
  return section(
    "What the muscles explain",
    chart(
      barChart(bars),
      "Part of the un-posed motion of the training frames that the strains of a muscle explain beyond what was chosen " +
        `before them${more > 0 ? `; ${plural(more, "muscle")} with less not shown` : ""}.`,
    ),
    useless.length > 0 ? paragraph(names) : null,
  );
}

function flexedSection(figures, pictures) {
  const { flexed } = figures;
  if (!flexed || !pictures.flexed) return null;
  const controls = Object.entries(flexed.controls).sort((a, b) => b[1] - a[1]);
  const named = controls.slice(0, 6).map(([name, value]) => `${name} ${numberText(value, 2)}`);
  const more = controls.length - named.length;
  return section(
    "What flexing does",
    pictureFigure(
      pictures.flexed,
      ["at rest", "flexed", "what flexing moves"],
      `The most that is flexed: frame ${flexed.frame} of take '${flexed.take}'`,
      `The learned skin in one pose, seen from where flexing moves it most, by ${millimetres(flexed.max_mm)}: ` +
        `${named.join(", ")}${more > 0 ? ` and ${plural(more, "control")} more` : ""}.`,
      colourBar(flexed.heat_scale_mm),
    ),
  );
}

function sectionsSection(figures, pictures) {
  const { sections } = figures;
  if (!sections || !pictures.sections) return null;
  const named = sections.names.map((name, k) => `${k + 1} ${name}`);
  return section(
    "What lies inside",
    pictureFigure(
      pictures.sections,
      ["at rest", "flexed", "at rest", "flexed"],
      `Sections at rest, and in frame ${sections.frame} of take '${sections.take}', in which muscles are flexed most`,
      `${named.join(", ")}. Bone ivory, fat yellow, cavity grey-blue, tendon white, other lean tissue pale red; every ` +
        "muscle a red of its own. Points of the posed sections go back to rest by the joints of the nearest skin: a " +
        "picture, and not the simulation's tets.",
    ),
  );
}

// "take 'walk': 12, 40; take 'run': 7", in the order of the frames.
function frameList(axis, columns) {
  const lists = new Map();
  for (const column of [...columns].sort((a, b) => a - b)) {
    const take = axis.takes.findLast((one) => one.first_index <= column);
    const prefix = take ? `take '${take.name}': ` : "";
    lists.set(prefix, [...(lists.get(prefix) ?? []), axis.frames[column]]);
  }
  return [...lists].map(([prefix, frames]) => prefix + frames.join(", ")).join("; ");
}

function coverageSection(figures) {
  const { coverage, heldout } = figures;
  if (!coverage) return null;
  const learned = learnedOf(figures);
  const curves = [
    { label: "true", colour: colours.learned, y: learned.frame_rms_mm, isEmphasised: true },
    { label: "expected", colour: colours.ddm, y: coverage.frame_expected_rms_mm },
  ];
  const rho = numberText(coverage.rank_correlation);
  const alike =
    coverage.rank_correlation === null
      ? ""
      : ` The frames' expected and true errors rank alike with Spearman's rho ${rho} (1: in the same order; 0: in none).`;
  const { frame_expected_rms_mm: frames, frame_region_expected_mm: regions } = coverage;
  return section(
    "Expected errors: what the basis does not know",
    chart(
      heatStrip(heldout, frames, coverage.regions, regions),
      "The error to expect of every held-out frame, by how far its pose is from what was learned, without looking at " +
        "its shape: over the whole skin on top, then in every region.",
    ),
    chart(
      linePlot("held-out frame", "RMS error, mm", heldout, curves),
      "Expected and true RMS error of every held-out frame.",
    ),
    paragraph(
      `Over all held-out frames ${millimetres(coverage.expected_rms_mm)} RMS are expected; ` +
        `it is ${millimetres(learned.errors_mm.rms)}.${alike}`,
    ),
  );
}

function tradeOffSection(figures) {
  const { trade_off: curve } = figures;
  if (curve.length < 2) return null;
  const rows = curve.map((point) => [
    fixedText(point.bytes_per_vertex, 0),
    ...[point.expected_rms_mm, point.coefficients, point.microseconds].map((value) => numberCell(value)),
  ]);
  return section(
    "Bytes against millimetres",
    chart(
      tradeOffPlot(curve, figures, learnedOf(figures)?.errors_mm.rms),
      "Bases that this training could have given (train --budget, --tolerance), by their bytes per vertex: the RMS " +
        "error that cross-validation on the training frames expects.",
    ),
    table(["bytes per vertex", "expected RMS, mm", "coefficients", "a frame on one core, us (estimate)"], rows),
  );
}

function unposingSection(figures) {
  const { lbs, ddm } = figures.unposing_residual_mm;
  const bars = [
    { label: "after un-posing by LBS", colour: colours.lbs, value: lbs, text: millimetres(lbs) },
    { label: "after un-posing by DDM", colour: colours.ddm, value: ddm, text: millimetres(ddm) },
  ];
  return section(
    "What is left to learn",
    chart(
      barChart(bars),
      "Over the training frames: RMS of the displacement between the true shape, taken back to the rest pose, and the " +
        "rest shape: the smaller it is, the less a residual has to carry.",
    ),
  );
}

// What `bodyopt demo` has done besides.
function demoFacts({ simulation, seconds, cpu_gpu_max_difference_m: apart }) {
  if (!simulation) return [];
  return [
    [
      "simulation",
      `${simulation.converged} of ${plural(simulation.frames, "frame")} converged; force left over, relative to the ` +
        `elastic forces: median ${numberText(simulation.median_residual, 2)}, ` +
        `worst ${numberText(simulation.worst_residual, 2)}; ` +
        `on average ${numberText(simulation.mean_iterations)} iterations a frame`,
    ],
    [
      "draft of the held-out motion",
      `in ${secondsText(seconds.draft)}, ${millimetres(simulation.draft_rms_mm)} RMS from the simulation, ` +
        `${millimetres(simulation.draft_max_mm)} at most`,
    ],
    ["GPU against CPU", `at most ${numberText(1e6 * apart)} micrometres apart, over all held-out frames and vertices`],
    [
      "time besides",
      `character ${secondsText(seconds.build_character)}, simulation ${secondsText(seconds.simulate)}, ` +
        `evaluation of the held-out frames ${secondsText(seconds.eval)}`,
    ],
  ];
}

function detailsSection(figures) {
  const { character, dataset } = figures;
  const box = character.bounding_box_m.map((extent) => numberText(extent)).join(" x ");
  const stages = Object.entries(figures.bytes_by_stage).map(([stage, bytes]) => `${stage} ${numberText(bytes)}`);
  const tables = [`${numberText(figures.bytes_per_vertex)} bytes per vertex`, stages.join(", ")];
  const facts = [
    [
      "character",
      `${character.name}: ${character.vertices} vertices, ${plural(character.joints, "joint")}, ` +
        `${plural(character.muscles, "muscle")}; ${box} m`,
    ],
    ["training frames", String(dataset.train_frames)],
    ["held-out frames", String(dataset.heldout_frames)],
    ["frames left out", `${dataset.unconverged} whose simulation did not converge`],
    ["tables", tables.filter((text) => text !== "").join(": ")],
    ...(figures.methods.length > 0 ? [["evaluated on", figures.device]] : []),
    ["training", `in ${secondsText(figures.seconds.train)}`],
    ["peak memory", `${numberText(figures.peak_memory_mib)} MiB`],
  ];
  return section("Details", table(["what", "value"], [...facts, ...demoFacts(figures)]));
}

function provenanceSection({ provenance }) {
  const facts = [
    ["program", provenance.program],
    ["command line", provenance.command_line],
    ...Object.entries(provenance.options),
    ["checksum of the basis", provenance.basis_checksum],
    ["hash of the topology", provenance.topology_hash],
    ["hash of the skeleton", provenance.skeleton_hash],
  ];
  const files = provenance.files.map((file) => [file.what, file.path, file.xxh3]);
  const takes = provenance.takes.map((take) => [take.name, take.trained, take.heldout, take.left_out]);
  return section(
    "To repeat it",
    table(["what", "value"], facts),
    table(["file", "path", "xxh3"], files),
    table(["take", "trained on", "held out", "left out"], takes),
  );
}

function reportKind({ character, dataset }) {
  return {
    title: `How the skin of ${character.name || "the character"} moves`,
    subtitle:
      `Bodyopt: learned from ${plural(dataset.train_frames, "frame")}, ` +
      `measured on ${plural(dataset.heldout_frames, "held-out frame")}`,
    sections: Object.entries({
      summary: summarySection,
      now: nowSection,
      warnings: warningsSection,
      takes: takesSection,
      pictures: picturesSection,
      methods: methodsSection,
      curves: curvesSection,
      jiggle: jiggleSection,
      regions: regionsSection,
      muscles: musclesSection,
      flexing: flexedSection,
      sections: sectionsSection,
      coverage: coverageSection,
      "trade-off": tradeOffSection,
      unposing: unposingSection,
      details: detailsSection,
      provenance: provenanceSection,
    }),
  };
}
