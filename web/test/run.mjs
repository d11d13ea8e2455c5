// Runs the unit tests: each test/*.test.ts is bundled, and run by node:test. Arguments are parts of file names.
import { spawnSync } from "node:child_process";
import { mkdtemp, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const wanted = process.argv.slice(2);
const files = await readdir(here, { recursive: true });
const tests = files.filter((name) => name.endsWith(".test.ts") && (wanted.length === 0 || wanted.some((part) => name.includes(part))));
if (tests.length === 0) {
    console.error("No unit test has this name.");
    process.exit(1);
}
const folder = await mkdtemp(join(tmpdir(), "coppice-web-"));
try {
    await build({
        absWorkingDir: dirname(here),
        entryPoints: tests.map((name) => join(here, name)),
        outdir: folder,
        outbase: here,
        outExtension: { ".js": ".mjs" },
        bundle: true,
        format: "esm",
        platform: "node",
        target: "node18",
        jsx: "automatic",
        jsxImportSource: "preact",
        loader: { ".css": "empty" },
        sourcemap: "inline",
        logLevel: "warning",
    });
    const bundles = tests.map((name) => join(folder, name.replace(/\.ts$/, ".mjs")));
    const run = spawnSync(process.execPath, ["--enable-source-maps", "--test", ...bundles], { stdio: "inherit" });
    process.exitCode = run.status ?? 1;
} finally {
    await rm(folder, { recursive: true });
}
