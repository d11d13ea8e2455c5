// Bundles the page: npm run build -- --outdir=DIR. Writes index.html, app.js, app.css and worker.js.
import { copyFile, mkdir, readdir, readFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const kMaxBytes = 400 * 1024; // gzipped, all files together

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { outdir: { type: "string", default: "dist" }, debug: { type: "boolean" } } });
const outdir = resolve(values.outdir);

await mkdir(outdir, { recursive: true });
await build({
    absWorkingDir: here,
    entryPoints: { app: "src/main.tsx", worker: "src/worker.ts" },
    outdir,
    bundle: true,
    format: "esm",
    target: "es2022",
    minify: !values.debug,
    sourcemap: values.debug ? "inline" : false,
    legalComments: "none",
    logLevel: "warning",
});
await copyFile(join(here, "src/index.html"), join(outdir, "index.html"));

let bytes = 0;
for (const name of ["index.html", "app.js", "app.css", "worker.js"]) {
    bytes += gzipSync(await readFile(join(outdir, name))).length;
}
const others = (await readdir(outdir)).length - 4;
console.log(`The page: ${(bytes / 1024).toFixed(0)} KB gzipped${others > 0 ? `; ${others} other files in the folder` : ""}.`);
if (bytes > kMaxBytes && !values.debug) {
    console.error(`The page is larger than ${kMaxBytes / 1024} KB gzipped; take something out.`);
    process.exit(1);
}
