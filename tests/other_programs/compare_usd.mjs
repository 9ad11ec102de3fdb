// node compare_usd.mjs MODULES SHOT.usda SHOT.pc2: exits with 1 where three.js reads other points, triangles or frames from
// the .usda than the .pc2 holds, in any sample; with a word more, texture coordinates are wanted, too.
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const [modules, usda, pc2, textured] = process.argv.slice(2);
const three = (file) => import(pathToFileURL(`${modules}/three/examples/jsm/loaders/${file}`));
const {USDAParser} = await three('usd/USDAParser.js');
const {USDLoader} = await three('USDLoader.js');
const text = readFileSync(usda, 'utf8');

const bytes = readFileSync(pc2);
const points = bytes.readInt32LE(16), start = bytes.readFloatLE(20), samples = bytes.readInt32LE(28);
const sample = (k) => new Float32Array(bytes.buffer.slice(bytes.byteOffset + 32 + k * points * 12,
                                                          bytes.byteOffset + 32 + (k + 1) * points * 12));
function require(holds, what) {
  if (holds) return;
  console.error(`${usda}: ${what}`);
  process.exit(1);
}

const specs = new USDAParser().parseData(text).specsByPath;
const field = (name) => Object.entries(specs).find(([path]) => path.endsWith(`.${name}`))[1].fields;
const {times, values} = field('points').timeSamples;
require(values.length === samples && times[0] === start, `${values.length} samples from ${times[0]}, PC2 has ${samples}`);
for (let k = 0; k < samples; ++k) {
  const expected = sample(k), found = Float32Array.from(values[k].flat());
  require(found.length === expected.length, `sample ${k} has ${found.length / 3} points, PC2 ${points}`);
  require(found.every((value, i) => value === expected[i]), `sample ${k} holds other points`);
}
require(field('normals').timeSamples.values.length === samples, 'normals are missing');

// The mesh as a renderer gets it: a corner after the other.
const corners = field('faceVertexIndices').default, first = sample(0);
let mesh = null;
new USDLoader().parse(text).traverse((object) => { mesh = object.isMesh ? object : mesh; });
require(mesh !== null, 'no mesh');
const {position} = mesh.geometry.attributes, index = mesh.geometry.index;
const corner = (c) => (index ? index.getX(c) : c);
require((index ?? position).count === corners.length, `${(index ?? position).count} corners, expected ${corners.length}`);
for (let c = 0; c < corners.length; ++c) {
  for (const [axis, value] of [position.getX(corner(c)), position.getY(corner(c)), position.getZ(corner(c))].entries()) {
    require(value === first[3 * corners[c] + axis], `corner ${c} lies elsewhere`);
  }
}
if (textured) {
  const {uv} = mesh.geometry.attributes, given = field('primvars:st').default;
  const numbers = given.flat();
  require(uv && numbers.length === 2 * points, `${numbers.length / 2} texture coordinates of ${points} points`);
  for (let c = 0; c < corners.length; ++c) {
    require(Math.abs(uv.getX(corner(c)) - numbers[2 * corners[c]]) < 1e-6, `corner ${c} has another texture coordinate`);
  }
}
console.log(`three.js: ${samples} samples of ${points} points, ${corners.length / 3} triangles, all equal`);
