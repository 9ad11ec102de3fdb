// read_page.mjs PAGE DOM: what a browser made of a page has the figures that the page holds.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const [page, dom] = process.argv.slice(2).map((file) => readFileSync(file, "utf8"));
const { kind, figures } = JSON.parse(page.match(/id="contents">(.*?)<\/script>/s)[1]);
const main = dom.match(/<main id="page">(.*?)<\/main>/s)[1];
const text = main
  .replace(/<[^>]*>/g, " ")
  .replaceAll("&lt;", "<")
  .replaceAll("&gt;", ">")
  .replaceAll("&amp;", "&");

const short = (value) => String(Number(value.toPrecision(3)));
const expected = {
  report: () => [
    ...figures.methods.flatMap(({ name, errors_mm: errors }) => [name, short(errors.rms), short(errors.max)]),
    ...figures.regions.flatMap((region) => [region.name, short(region.moves_rms_mm)]),
    ...figures.takes.map((take) => short(take.full_mm)),
    ...[figures.provenance.command_line, figures.provenance.basis_checksum, figures.jiggle.device],
  ],
  show: () =>
    figures.elements.flatMap((one) => [one.shot, one.element]).concat(figures.worth_a_look.map((one) => one.shot)),
  transfer: () =>
    figures.targets.flatMap((one) => [one.target, ...one.parts.flatMap((part) => [part.joint, part.size.toFixed(2)])]),
};
for (const figure of expected[kind]()) assert.ok(text.includes(figure), `${kind}: '${figure}' is not shown`);
assert.doesNotMatch(text, /NaN|undefined|null|cannot be/);
assert.doesNotMatch(main, /class="[^"]*broken/);
const pictures = [...main.matchAll(/<(?:img|image) [^>]*?(?:src|href)="([^"]{5})/g)].map(([, source]) => source);
assert.ok(pictures.length > 0 && pictures.every((source) => source === "data:"), `${kind}: pictures from ${pictures}`);
console.log(`${kind}: ${expected[kind]().length} figures and ${pictures.length} pictures are shown`);
