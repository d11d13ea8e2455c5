// node validate.mjs FILE.glb ...: exits with 1 if the Khronos validator finds an error or a warning in any of the files.
import { readFile } from "node:fs/promises";
import { validateBytes } from "gltf-validator";

const [...files] = process.argv.slice(2);
let sound = files.length > 0;
for (const file of files) {
  const report = await validateBytes(new Uint8Array(await readFile(file)), { maxIssues: 0 });
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${report.info.totalTriangleCount} triangles`);
  for (const { code, message, pointer } of messages.slice(0, 20)) console.log(`  ${code} ${pointer ?? ""} ${message}`);
  sound &&= numErrors === 0 && numWarnings === 0;
}
process.exit(sound ? 0 : 1);
