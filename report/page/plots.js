"use strict";
// Bars, colours and curves as SVG.

const colours = {
  grid: "#33373f",
  text: "#a4a9b3",
  strong: "#e6e8ec",
  panel: "#1c1f25",
  learned: "#f2b866",
  ddm: "#62aee8",
  lbs: "#8a92a1",
  linear: "#b892f2",
  other: "#59606d",
  heldout: "#e8837a",
};
const plotWidth = 960;
const characterWidth = 7.2; // of a text in the usual size, about

function plot(width, height, description, ...children) {
  const attributes = { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": description, "font-size": 13 };
  return shape("svg", attributes, ...children);
}

function line(x1, y1, x2, y2, stroke) {
  return shape("line", { x1, y1, x2, y2, stroke });
}

function rectangle(x, y, width, height, fill) {
  return shape("rect", { x, y, width, height, rx: 2, fill });
}

function textAt(x, y, anchor, fill, text, attributes = {}) {
  return shape("text", { x, y, "text-anchor": anchor, fill, ...attributes }, text);
}

// Bars from 0: {label, colour, value, text at the end}.
function barChart(bars) {
  const row = 34;
  const longest = largestOf(bars.map((bar) => bar.value));
  const left = Math.max(190, 16 + characterWidth * largestOf(bars.map((bar) => bar.label.length)));
  const drawn = bars.flatMap((bar, k) => {
    const y = 2 + k * row;
    const length = longest > 0 ? Math.max(2, (bar.value / longest) * (plotWidth - left - 110)) : 2;
    return [
      textAt(left - 12, y + 21, "end", colours.strong, bar.label),
      rectangle(left, y + 5, length, row - 10, bar.colour),
      textAt(left + length + 10, y + 21, "start", colours.strong, bar.text),
    ];
  });
  return plot(plotWidth, row * bars.length + 4, "bars", ...drawn);
}

// The colours of the pictures, from 0 to a scale in millimetres: as parts of an SVG, and as one.
function colourRamp(x, y, width, scaleMm) {
  const step = width / heatColours.length;
  const rects = heatColours.map((fill, i) =>
    shape("rect", { x: x + i * step, y, width: step + 0.6, height: 14, "shape-rendering": "crispEdges", fill }),
  );
  const ticks = [0, 1, 2, 3, 4].flatMap((i) => {
    const at = x + (i * width) / 4;
    const text = numberText((scaleMm * i) / 4) + (i === 4 ? " mm" : "");
    return [line(at, y + 14, at, y + 19, colours.text), textAt(at, y + 32, "middle", colours.text, text)];
  });
  return [...rects, ...ticks];
}

function colourBar(scaleMm) {
  return plot(360, 40, `colours from 0 to ${millimetres(scaleMm)}`, ...colourRamp(24, 2, 312, scaleMm));
}

// Where a value lies in an area {left, right, top, bottom} that is logarithmic from low to high.
function logScale(area, low, high) {
  return (value) => {
    const clamped = Math.min(Math.max(value, low), high);
    return area.bottom - (Math.log(clamped / low) / Math.log(high / low)) * (area.bottom - area.top);
  };
}

// Lines across such an area, with values at the left.
function logAxis(area, low, high, label) {
  const y = logScale(area, low, high);
  const drawn = [];
  for (let decade = 10 ** Math.floor(Math.log10(low)); decade <= high; decade *= 10) {
    for (const value of [decade, 2 * decade, 5 * decade]) {
      if (value < low * 0.999 || value > high * 1.001) continue;
      drawn.push(line(area.left, y(value), area.right, y(value), colours.grid));
      drawn.push(textAt(area.left - 8, y(value) + 4, "end", colours.text, numberText(value)));
    }
  }
  const [x, middle] = [area.left - 48, (area.top + area.bottom) / 2];
  const turned = { transform: `rotate(-90 ${x} ${middle})` };
  return [...drawn, textAt(x, middle, "middle", colours.text, label, turned)];
}

// A mark whose words stand beside it, where the curve is not: above to the right, or below to the left.
function mark(x, y, area, colour, text, isAbove) {
  const isLeft = isAbove ? x > area.right - 300 : x > area.left + 300;
  const shift = isAbove ? (isLeft ? 8 : -8) : 0;
  return [
    shape("circle", { cx: x, cy: y, r: 6.5, fill: "none", "stroke-width": 2.5, stroke: colour }),
    textAt(x + shift, isAbove ? y - 14 : y + 24, isLeft ? "end" : "start", colour, text),
  ];
}

function byteTicks(area, x, first, last) {
  const step = roundUp((last - first) / 10);
  const drawn = [];
  for (let bytes = Math.ceil(first / step) * step; bytes <= last; bytes += step) {
    drawn.push(line(x(bytes), area.bottom, x(bytes), area.bottom + 5, colours.text));
    drawn.push(textAt(x(bytes), area.bottom + 19, "middle", colours.text, numberText(bytes, 9)));
  }
  return drawn;
}

// Bytes from left to right, millimetres upwards. Points {bytes_per_vertex, expected_rms_mm}, the chosen one among them;
// `heldoutMm`: its error as measured, or undefined.
function tradeOffPlot(curve, chosen, heldoutMm) {
  const area = { left: 62, right: 946, top: 20, bottom: 350 };
  const bytes = [chosen, ...curve].map((point) => point.bytes_per_vertex);
  const mm = [chosen, ...curve].map((point) => point.expected_rms_mm).concat(heldoutMm ?? []);
  const margin = 0.04 * Math.max(1, Math.max(...bytes) - Math.min(...bytes));
  const [first, last] = [Math.min(...bytes) - margin, Math.max(...bytes) + margin];
  const high = Math.max(...mm);
  const [lowest, highest] = [0.8 * Math.max(Math.min(...mm), 1e-4 * high), 1.25 * Math.max(high, 1e-9)];
  const x = (value) => area.left + ((value - first) / (last - first)) * (area.right - area.left);
  const y = logScale(area, lowest, highest);
  const places = curve.map((point) => [x(point.bytes_per_vertex), y(point.expected_rms_mm)]);
  const isHeldoutAbove = heldoutMm > chosen.expected_rms_mm;
  const at = x(chosen.bytes_per_vertex);
  const expected = `this basis, expected: ${millimetres(chosen.expected_rms_mm)}`;
  const marks = mark(at, y(chosen.expected_rms_mm), area, colours.learned, expected, !isHeldoutAbove);
  if (heldoutMm !== undefined) {
    marks.push(...mark(at, y(heldoutMm), area, colours.heldout, `held out: ${millimetres(heldoutMm)}`, isHeldoutAbove));
  }
  return plot(
    plotWidth,
    400,
    "RMS error over bytes per vertex",
    ...logAxis(area, lowest, highest, "RMS error, mm"),
    ...byteTicks(area, x, first, last),
    textAt((area.left + area.right) / 2, 392, "middle", colours.text, "bytes per vertex"),
    shape("path", { d: `M${places.join("L")}`, fill: "none", stroke: colours.ddm, "stroke-width": 1.6 }),
    ...places.map(([cx, cy]) => shape("circle", { cx, cy, r: 3, fill: colours.ddm })),
    ...marks,
  );
}
