// node compare_rigged.mjs MODULES RIGGED.usda CACHE.pc2 FPS: exits with 1 where what three.js has bound by UsdSkel, with a
// frame's blend shape, which it does not read, added to its points, is elsewhere than the points of the cache.
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const [modules, usda, cache, fps] = process.argv.slice(2);
globalThis.document = {createElementNS: () => ({addEventListener() {}, removeEventListener() {}})};  // for its images
const three = (file) => import(pathToFileURL(`${modules}/three/${file}`));
const {AnimationMixer, Vector3} = await three('build/three.module.js');
const {USDLoader} = await three('examples/jsm/loaders/USDLoader.js');
function require(holds, what) {
  if (holds) return;
  console.error(`${usda}: ${what}`);
  process.exit(1);
}

const text = readFileSync(usda, 'utf8');
const numbers = (line) => line.match(/-?\d[\d.e+-]*/g).map(Number);
const points = numbers(text.match(/point3f\[\] points = (.*)/)[1]);
const shapes = [...text.matchAll(/vector3f\[\] offsets = (.*)/g)].map((match) => numbers(match[1]));
const bytes = readFileSync(cache);
const count = bytes.readInt32LE(16), first = bytes.readFloatLE(20), samples = bytes.readInt32LE(28);
require(points.length === 3 * count && shapes.length === samples, `${points.length} numbers, ${shapes.length} shapes`);

const root = new USDLoader().parse(text);
let skin = null;
root.traverse((object) => { if (object.isSkinnedMesh) skin = object; });
require(skin, 'no skinned mesh');
// three.js has a vertex for each corner of a triangle.
const key = (x, y, z) => [x, y, z].map(Math.fround).join(' ');
const known = new Map();
for (let v = 0; v < count; ++v) known.set(key(points[3 * v], points[3 * v + 1], points[3 * v + 2]), v);
const rest = skin.geometry.attributes.position;
const mixer = new AnimationMixer(root);
mixer.clipAction(root.animations[0]).play();
let worst = 0, added = 0;
for (let k = 0; k < samples - 1; ++k) {  // at the end it loops
  mixer.setTime((first + k) / fps);
  root.updateMatrixWorld(true);
  for (let i = 0; i < rest.count; ++i) {
    const v = known.get(key(rest.getX(i), rest.getY(i), rest.getZ(i)));
    require(v !== undefined, `three.js has a vertex ${i} that the file has not`);
    const offset = new Vector3(...shapes[k].slice(3 * v, 3 * v + 3));
    const point = skin.applyBoneTransform(i, new Vector3().fromBufferAttribute(rest, i).add(offset));
    const wanted = [0, 1, 2].map((axis) => bytes.readFloatLE(32 + 12 * (k * count + v) + 4 * axis));
    worst = Math.max(worst, point.distanceTo(new Vector3(...wanted)));
    added = Math.max(added, offset.length());
  }
}
require(added > 1e-3, `blend shapes add ${added} m only`);
require(worst < 1e-5, `points are up to ${worst} m from the cache`);
console.log(`three.js: a bound skin of ${count} points over ${samples} frames, within ${worst.toExponential(1)} m`);
