// Runs the Khronos validator over GLB files: node validate_glb.mjs FILE...
// The npm package gltf-validator is looked for in the folder GLTF_VALIDATOR_HOME, then where node
// looks. Exit status: 0 no errors and no warnings, 1 some, 2 unreadable, 77 the package is missing.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

function loadValidator() {
  const homes = [process.env.GLTF_VALIDATOR_HOME, process.cwd(), import.meta.dirname ?? '.'];
  for (const home of homes.filter(Boolean)) {
    try {
      return createRequire(join(home, 'anything.js'))('gltf-validator');
    } catch (error) {
      if (error.code !== 'MODULE_NOT_FOUND') throw error;
    }
  }
  console.error('the npm package gltf-validator is not installed');
  process.exit(77);
}

const validator = loadValidator();
let status = 0;
for (const file of process.argv.slice(2)) {
  let bytes;
  try {
    bytes = new Uint8Array(readFileSync(file));
  } catch (error) {
    console.error(`${file}: ${error.message}`);
    process.exit(2);
  }
  const { issues } = await validator.validateBytes(bytes, { uri: file, maxIssues: 20 });
  console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ` +
              `${issues.numInfos} infos, ${issues.numHints} hints`);
  for (const issue of issues.messages) {
    console.log(`  ${issue.code} ${issue.pointer ?? ''}: ${issue.message}`);
  }
  if (issues.numErrors + issues.numWarnings > 0) status = 1;
}
process.exit(status);
