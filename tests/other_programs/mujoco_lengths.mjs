// node mujoco_lengths.mjs MODULES MODEL.xml OUT.json: lengths of a model's tendons, metres, by MuJoCo, in the model's
// default pose and in 33 random ones within the limits of its joints.
import {existsSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, dirname, join} from 'node:path';
import {pathToFileURL} from 'node:url';

const [modules, path, out] = process.argv.slice(2);
const mujoco = await (await import(pathToFileURL(`${modules}/@mujoco/mujoco/mujoco.js`))).default();

// The model as one text, without what only pictures need and a copy of the model may lack: what is not there to be
// included, meshes, height fields and materials. MuJoCo wants a mass where a mesh had given one.
const read = (file) => readFileSync(file, 'utf8').replace(/^\ufeff/, '').replace(/<!--[^]*?-->/g, '');
const include = (text) => text.replace(/<include\s+file="([^"]*)"\s*\/>/g, (element, name) => {
  const file = join(dirname(path), name);
  if (!existsSync(file)) return '';
  return include(read(file).replace(/^\s*<mujocoinclude[^>]*>/, '').replace(/<\/mujocoinclude>\s*$/, ''));
});
const whole = include(read(path))
  .replace(/<(asset|visual)>[^]*?<\/\1>/g, '')
  .replace(/<geom\b[^>]*\b(mesh|hfield)="[^"]*"[^>]*?(\/>|>\s*<\/geom>)/g, '')
  .replace(/\smaterial="[^"]*"/g, '')
  .replace(/<mujoco\b[^>]*>/, '$&<compiler boundmass="0.001" boundinertia="0.001"/>');

const model = mujoco.MjModel.from_xml_string(whole);
const data = new mujoco.MjData(model);
const text = new TextDecoder(), names = Uint8Array.from(model.names);
const name = (address) => text.decode(names.subarray(address, names.indexOf(0, address)));
const joints = Array.from(model.name_jntadr, name), tendons = Array.from(model.name_tendonadr, name);

let seed = 1;
function random() { // Park and Miller's generator
  seed = seed * 48271 % 2147483647;
  return seed / 2147483647;
}
const poses = [], lengths = [];
for (let pose = 0; pose < 34; ++pose) {
  mujoco.mj_resetData(model, data);
  const values = joints.map((joint, j) => {
    const [low, high] = model.jnt_range.subarray(2 * j, 2 * j + 2), place = model.jnt_qposadr[j];
    if (pose > 0 && low < high) data.qpos[place] = Number((low + (high - low) * random()).toFixed(4));
    return data.qpos[place];
  });
  mujoco.mj_fwdPosition(model, data);
  poses.push(values);
  lengths.push(Array.from(data.ten_length, (length) => Number(length.toFixed(7))));
}

const rows = (list) => `[\n    ${list.map((row) => JSON.stringify(row)).join(',\n    ')}\n  ]`;
writeFileSync(out, `{
  "computed_by": "MuJoCo ${mujoco.mj_versionString()}",
  "model": "${basename(path)}",
  "joints": ${JSON.stringify(joints)},
  "tendons": ${JSON.stringify(tendons)},
  "poses": ${rows(poses)},
  "lengths": ${rows(lengths)}
}
`);
