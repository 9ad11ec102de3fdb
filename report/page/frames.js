"use strict";
// What is drawn over frames: from left to right, a column each, take after take. An axis has the `frames` of the columns
// and `takes` by their first: {name, first_index}; none: all of one take.

// Of every column the smallest step from one frame to the next in its take, 1 at least.
function usualSteps(axis) {
  const steps = axis.frames.map(() => 1);
  const begins = [...new Set([0, ...axis.takes.map((take) => take.first_index)]), steps.length];
  for (let t = 0; t + 1 < begins.length; ++t) {
    const own = axis.frames.slice(begins[t], begins[t + 1]);
    const step = own.slice(1).reduce((least, frame, k) => Math.min(least, frame - own[k]), Infinity);
    if (own.length > 1) steps.fill(step, begins[t], begins[t + 1]);
  }
  return steps;
}

function beginsTake(axis, column) {
  return column === 0 || axis.takes.some((take) => take.first_index === column);
}

// True where a column does not follow on the one before: it begins a take, or frames between them are missing.
function gaps(axis) {
  const steps = usualSteps(axis);
  return steps.map((step, k) => beginsTake(axis, k) || axis.frames[k] - axis.frames[k - 1] > step);
}

// Middle of a column.
function columnX(axis, area, column) {
  return area.left + ((column + 0.5) / Math.max(1, axis.frames.length)) * (area.right - area.left);
}

function takeNames(axis, area) {
  const half = (area.right - area.left) / (2 * axis.frames.length);
  let freeFrom = area.left;
  return axis.takes.flatMap((take) => {
    const x = columnX(axis, area, take.first_index) - half;
    const border = line(x, area.top, x, area.bottom, colours.text);
    const width = characterWidth * take.name.length;
    if (x < freeFrom || x + width > area.right) return [border];
    freeFrom = x + width + 6;
    return [border, textAt(x + 3, area.top - 5, "start", colours.text, take.name)];
  });
}

// Numbers below: of the first frame of every take, and of those at or past a multiple of a round number. Of several
// takes, the name above and a line where each begins.
function frameAxis(axis, area) {
  const steps = usualSteps(axis);
  const multiple = (k, step) => Math.floor(axis.frames[k] / step);
  const drawn = axis.takes.length > 1 ? takeNames(axis, area) : [];
  let freeFrom = 0;
  axis.frames.forEach((frame, k) => {
    const step = roundUp((axis.frames.length / 12) * steps[k]);
    const x = columnX(axis, area, k);
    if (x < freeFrom || !(beginsTake(axis, k) || multiple(k, step) > multiple(k - 1, step))) return;
    freeFrom = x + 46; // the room of a frame number
    drawn.push(line(x, area.bottom, x, area.bottom + 5, colours.text));
    drawn.push(textAt(x, area.bottom + 19, "middle", colours.text, String(frame)));
  });
  return drawn;
}

// The scale of curves: the lower end never under a thousandth of the upper.
function curveScale(series) {
  const values = series.flatMap((one) => one.y).filter((value) => Number.isFinite(value) && value > 0);
  if (values.length === 0) return [0.1, 1];
  const lowest = values.reduce((low, value) => Math.min(low, value));
  const high = roundUp(1.05 * largestOf(values));
  const low = Math.max(roundUp(lowest) / 2.5, high / 1000);
  return [low > lowest ? Math.max(0.8 * lowest, high / 1000) : low, high];
}

// A curve's path, broken where frames or values are missing; what stands alone is a dot.
function curvePath(axis, area, values, y) {
  const isBroken = gaps(axis);
  const isThere = (k) => k >= 0 && k < axis.frames.length && Number.isFinite(values[k]);
  const begins = (k) => isBroken[k] || !isThere(k - 1);
  return axis.frames
    .map((frame, k) => {
      if (!isThere(k)) return "";
      const place = `${columnX(axis, area, k).toFixed(1)} ${y(values[k]).toFixed(1)}`;
      const isAlone = begins(k) && (!isThere(k + 1) || begins(k + 1));
      return (begins(k) ? "M" : "L") + place + (isAlone ? "h0" : "");
    })
    .join("");
}

// Curves over frames on a logarithmic scale: {label, colour, y, isEmphasised}. Values at or below zero sit on its edge.
function linePlot(xLabel, yLabel, axis, series) {
  const area = { left: 62, right: 946, top: 46, bottom: 294 };
  const [low, high] = curveScale(series);
  const y = logScale(area, low, high);
  let x = area.left;
  const legend = series.flatMap((one) => {
    const at = x;
    x += 52 + characterWidth * one.label.length;
    return [rectangle(at, 10, 18, 4, one.colour), textAt(at + 24, 16, "start", colours.strong, one.label)];
  });
  const curves = series.map((one) =>
    shape("path", {
      d: curvePath(axis, area, one.y, y),
      fill: "none",
      "stroke-linejoin": "round",
      "stroke-linecap": "round",
      stroke: one.colour,
      "stroke-width": one.isEmphasised ? 2.8 : 1.6,
    }),
  );
  const below = textAt((area.left + area.right) / 2, 334, "middle", colours.text, xLabel);
  const axes = [...logAxis(area, low, high, yLabel), ...frameAxis(axis, area)];
  return plot(plotWidth, 340, `${yLabel} over ${xLabel}`, ...axes, ...legend, below, ...curves);
}

// Rows of errors as an image of a pixel per cell, the first row two pixels high. Where there are more frames than
// pixels, a column shows the worst of several.
function heatCells(rows, scaleMm) {
  const frames = rows[0].length;
  const canvas = element("canvas", { width: Math.min(frames, 700), height: rows.length + 1 });
  const pen = canvas.getContext("2d");
  rows.forEach((row, r) => {
    const worst = new Array(canvas.width).fill(0);
    row.forEach((mm, k) => {
      const column = Math.floor((k * canvas.width) / frames);
      worst[column] = Math.max(worst[column], mm);
    });
    worst.forEach((mm, column) => {
      pen.fillStyle = heatColours[Math.min(heatColours.length - 1, Math.floor((mm / scaleMm) * heatColours.length))];
      pen.fillRect(column, r === 0 ? 0 : r + 1, 1, r === 0 ? 2 : 1);
    });
  });
  return canvas.toDataURL();
}

// Errors of every frame and region as colours: the whole skin's row on top, a row per region below. `regionsMm`: per
// frame, of every region.
function heatStrip(axis, wholeMm, regions, regionsMm) {
  const rows = [wholeMm, ...regions.map((name, r) => regionsMm.map((frame) => frame[r]))];
  const scaleMm = heatScale(largestOf(rows.map(largestOf)));
  const height = regions.length > 30 ? 15 : 20;
  const names = regions.map((name) => (name.length > 30 ? `${name.slice(0, 27)}...` : name));
  const left = 24 + characterWidth * largestOf(["whole skin", ...names].map((name) => name.length));
  const area = { left, right: 936, top: 24, bottom: 24 + height * (rows.length + 1) };
  const [x, y, width] = [area.left, area.top, area.right - area.left];
  const cells = { x, y, width, height: area.bottom - y, preserveAspectRatio: "none", href: heatCells(rows, scaleMm) };
  const labels = names.flatMap((name, r) => {
    const top = area.top + height * (r + 2);
    return [
      line(area.left, top, area.right, top, colours.panel),
      textAt(area.left - 10, top + height / 2 + 4.5, "end", colours.text, name),
    ];
  });
  return plot(
    plotWidth,
    area.bottom + 100,
    "expected error of every frame and region",
    shape("image", { ...cells, style: "image-rendering: pixelated" }),
    textAt(area.left - 10, area.top + height + 5, "end", colours.strong, "whole skin", { "font-weight": 600 }),
    ...labels,
    ...frameAxis(axis, area),
    textAt((area.left + area.right) / 2, area.bottom + 38, "middle", colours.text, "frame"),
    textAt(area.left - 10, area.bottom + 67, "end", colours.text, "expected RMS"),
    ...colourRamp(area.left + 6, area.bottom + 56, 320, scaleMm),
  );
}
