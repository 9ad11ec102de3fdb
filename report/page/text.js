"use strict";
// Figures as words.

// A number with up to `digits` significant digits and no needless zeros; a dash where there is none.
function numberText(value, digits = 3) {
  if (!Number.isFinite(value)) return "-";
  const shown = Number(value.toPrecision(digits));
  return shown !== 0 && Math.abs(shown) < 1e-4 ? shown.toExponential() : String(shown);
}

// A number with so many decimals.
function fixedText(value, decimals) {
  return Number.isFinite(value) ? value.toFixed(decimals) : "-";
}

// How much more or less than 1 a ratio is.
function changeText(ratio) {
  const percent = fixedText(100 * (ratio - 1), 1);
  return (percent.startsWith("-") ? percent : `+${percent}`) + " %";
}

function millimetres(value) {
  return `${numberText(value)} mm`;
}

function plural(count, thing) {
  return `${count} ${thing}${count === 1 ? "" : "s"}`;
}

function secondsText(seconds) {
  if (!(seconds >= 90)) return `${numberText(seconds)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

// The smallest of these steps times a power of ten that is not below a value; 1 where the value is not above 0.
function roundUpTo(steps, value) {
  if (!(value > 0 && Number.isFinite(value))) return 1;
  const decade = 10 ** Math.floor(Math.log10(value));
  return (steps.find((step) => value <= step * decade * (1 + 1e-12)) ?? 10) * decade;
}

// A scale that is easy to read.
function roundUp(value) {
  return roundUpTo([1, 2, 5], value);
}

// A scale whose quarters are short numbers.
function heatScale(value) {
  return roundUpTo([1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8], value);
}

function largestOf(values) {
  return values.reduce((largest, value) => Math.max(largest, value), 0);
}
