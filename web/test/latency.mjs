// Latency and memory of the page of the studio: COPPICE=build/release/bin/coppice node web/test/latency.mjs TREE.swc
// Time from the start of the program until the page is usable; from each preview of a drag until it is drawn, compared with an
// echo on the same connection; and the growth of the heap of the page over a thousand previews.
import { readFile } from "node:fs/promises";
import { endBrowser, openPage, runLines, settled, startBrowser, startStudio } from "./browser/browser.mjs";

const kWarm = 100;
const kDrags = 1000;
const kHung = 500; // number of descendants of the dragged node

/** The node with about this number of descendants, in a file with sorted nodes. */
function nodeWith(text, wanted) {
    const parents = text
        .split("\n")
        .filter((line) => /^\s*\d/.test(line))
        .map((line) => Number(line.trim().split(/\s+/)[6]));
    const sizes = parents.map(() => 1);
    for (let i = parents.length - 1; i > 0; --i) {
        sizes[parents[i] - 1] += sizes[i];
    }
    return sizes.reduce((best, size, i) => (Math.abs(size - wanted) < Math.abs(sizes[best] - wanted) ? i : best), 0);
}

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const percentile = (values, share) => [...values].sort((a, b) => a - b)[Math.floor(values.length * share)];

const tree = await readFile(process.argv[2], "utf8");
const node = nodeWith(tree, kHung);
await startBrowser();
const begun = performance.now();
const studio = await startStudio();
const page = await openPage(studio, { viewport: { width: 1280, height: 800 }, deviceScaleFactor: 0.5, reducedMotion: "reduce" });
const ready = performance.now() - begun;

await studio.write("tree.swc", tree);
await page.evaluate(() => (globalThis.coppice.view.display.shadow.value = false));
await runLines(page, "loadtree tree tree.swc");
await page.evaluate(() => globalThis.coppice.view.frame());
await settled(page);

/** [ms] of a number of drags: until the engine responded and until the next frame. */
const drag = (count) =>
    page.evaluate(
        async ([id, most]) => {
            const { engine } = globalThis.coppice;
            const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
            const times = { echo: [], drag: [] };
            for (let i = 0; i < most; ++i) {
                let at = performance.now();
                await engine.request("ping");
                times.echo.push(performance.now() - at);
                at = performance.now();
                await engine.preview(`edit rotate tree id(${id}) ${(10 * Math.sin(0.2 * i)).toFixed(3)}`, { kind: "skeleton", name: "tree" });
                await frame();
                times.drag.push(performance.now() - at);
            }
            await engine.endPreview();
            return times;
        },
        [node, count],
    );

const session = await page.context().newCDPSession(page);
async function heap() {
    await settled(page);
    await session.send("HeapProfiler.collectGarbage");
    return (await session.send("Runtime.getHeapUsage")).usedSize / 2 ** 20;
}

await drag(kWarm);
const before = await heap();
const { echo, drag: drags } = await drag(kDrags);
const after = await heap();
console.log(
    JSON.stringify({
        ready_ms: Math.round(ready),
        echo_ms: median(echo),
        drag_ms: median(drags),
        drag_p95_ms: percentile(drags, 0.95),
        ratio: median(drags) / median(echo),
        heap_before_MiB: before,
        heap_after_MiB: after,
    }),
);
await endBrowser();
await studio.end();
