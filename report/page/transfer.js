"use strict";
// The page of a transfer, from what `transfer basis --json` writes: a section for every target.

function transferHeadlines(target) {
  const match = target.same_topology
    ? "confidence: the same triangles"
    : "confidence of the match (1: surely the same)";
  return headlines([
    [fixedText(target.likeness, 2), "", `likeness: under ${numberText(target.least_likeness)} are unlike bodies`],
    [fixedText(target.confidence, 2), "", match],
    [numberText(target.size_ratio), "times", "as large as the source"],
    [String(target.filled_in_vertices), `of ${target.vertices}`, "vertices are filled in from around"],
  ]);
}

function partsTable(parts) {
  const rows = parts.map((part) => [
    part.joint,
    numberCell(part.vertices, String(part.vertices)),
    numberCell(part.confidence, fixedText(part.confidence, 2)),
    numberCell(part.size, fixedText(part.size, 2)),
    numberCell(part.unevenness, `${fixedText(100 * part.unevenness, 0)} %`),
    part.breaks_assumption ? "another anatomy: a guess" : "",
  ]);
  return table(["held by", "vertices", "confidence", "size", "uneven by", ""], rows);
}

// What is shown of motion; nothing where there was no clip.
function posedBodies(target, picture) {
  const shown = target.poses.filter((pose) => pose.is_shown);
  if (shown.length === 0) return [];
  const rows = shown.map((pose) => [
    String(pose.frame),
    numberCell(pose.source_volume, changeText(pose.source_volume)),
    numberCell(pose.target_volume, changeText(pose.target_volume)),
    numberCell(pose.expected_rms_mm, fixedText(pose.expected_rms_mm, 2)),
  ]);
  const next = "Worth simulating next on the target, by the error that is expected: --frames ";
  return [
    pictureFigure(
      picture,
      shown.flatMap((pose) => [`frame ${pose.frame}: source`, "target"]),
      "The same poses",
      "The source by its basis, the target by what was carried, each as large as the picture.",
    ),
    table(["frame", "volume, source", "volume, target", "expected error, mm"], rows),
    paragraph("Volumes are what the skin encloses, against its rest."),
    target.worth_simulating === "" ? null : paragraph(next + target.worth_simulating),
  ];
}

function targetSection(target, pictures) {
  if (target.error) return section(target.target, paragraph(target.error));
  return section(
    target.target,
    transferHeadlines(target),
    pictureFigure(
      pictures.match,
      ["source, by place", "target, by its matches", "target, hot where unsure"],
      "Which point is which",
      "The same colour is the same point. Both in the pose in which they were matched.",
    ),
    partsTable(target.parts),
    paragraph(
      "Size: lengths along the skin, target over source. Uneven: how much that differs within the part. What is " +
        "carried rests on parts being alike but for their size; where they are not, simulate or sculpt.",
    ),
    ...posedBodies(target, pictures.poses),
  );
}

function transferKind({ title, subtitle, targets }) {
  const ofTarget = (target, k) => (all, pictures) => targetSection(target, pictures[k] ?? {});
  return { title, subtitle, sections: targets.map((target, k) => [target.target, ofTarget(target, k)]) };
}
