// node validate_gltf.mjs MODULES FILE...: prints every error of Khronos' gltf-validator; exits with 1 when there is one.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const [modules, ...files] = process.argv.slice(2);
const validator = createRequire(modules + '/')('gltf-validator');
let failed = files.length === 0;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {uri: file});
  const {numErrors, numWarnings, messages} = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings`);
  for (const message of messages) {
    if (message.severity <= 1) console.log(`  ${message.code} ${message.pointer ?? ''}: ${message.message}`);
  }
  failed ||= numErrors > 0;
}
process.exit(failed ? 1 : 0);
