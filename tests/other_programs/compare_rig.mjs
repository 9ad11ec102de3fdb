// node compare_rig.mjs MODULES RIG.usda RIG.glb FPS FIRST FRAMES: exits with 1 where three.js has a joint of the skeleton and
// its animation elsewhere by UsdSkel than by glTF, bound or in any frame.
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const [modules, usda, glb, fps, first, frames] = process.argv.slice(2);
globalThis.self = globalThis;  // which its glTF reader expects of a browser
const three = (file) => import(pathToFileURL(`${modules}/three/${file}`));
const {AnimationMixer, Bone, Vector3} = await three('build/three.module.js');
const {USDLoader} = await three('examples/jsm/loaders/USDLoader.js');
const {GLTFLoader} = await three('examples/jsm/loaders/GLTFLoader.js');
function require(holds, what) {
  if (holds) return;
  console.error(`${usda}: ${what}`);
  process.exit(1);
}

const usd = new USDLoader().parse(readFileSync(usda, 'utf8'));
require(usd.skeleton && usd.animations.length === 1, 'no skeleton with an animation');
const bytes = readFileSync(glb);
const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const bones = usd.skeleton.bones;
const top = bones.find((bone) => !bone.parent?.isBone);
const joint = (bone) => gltf.scene.getObjectByName(bone.name.replace(/\./g, ''));
require(bones.every(joint), `other joints: ${bones.map((bone) => bone.name)}`);

// As the joints are bound, which three.js has inverted.
const place = (object) => object.getWorldPosition(new Vector3());
let worst = 0, moved = 0;
const startOf = new Map();
const begin = usd.animations[0].tracks[0].times[0];
require(Math.abs(begin - first / fps) < 1e-4, `begins at ${begin} s, expected frame ${first}`);
const mixers = [new AnimationMixer(usd), new AnimationMixer(gltf.scene)];
mixers[0].clipAction(usd.animations[0]).play();
mixers[1].clipAction(gltf.animations[0]).play();
for (let frame = 0; frame < frames - 1; ++frame) {  // at the end it loops
  mixers[0].setTime(begin + frame / fps);
  mixers[1].setTime(frame / fps);
  top.updateWorldMatrix(true, true);
  gltf.scene.updateMatrixWorld(true);
  for (const bone of bones) {
    const found = place(bone);
    worst = Math.max(worst, found.distanceTo(place(joint(bone))));
    if (frame === 0) startOf.set(bone, found);
    moved = Math.max(moved, found.distanceTo(startOf.get(bone)));
  }
}
require(moved > 0.02, `the joints move by ${moved} m only`);
require(worst < 1e-5, `joints are up to ${worst} m from those of the glTF`);
console.log(`three.js: ${bones.length} joints over ${frames} frames from frame ${first}, within ${worst.toExponential(1)} m`);
