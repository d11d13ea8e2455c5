// The images of docs/user/studio.md: COPPICE=build/release/bin/coppice node web/test/pictures.mjs docs/pictures
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { PNG } from "pngjs";
import { endBrowser, openPage, placeOf, runLines, settled, startBrowser, startStudio } from "./browser/browser.mjs";
import { dragIn, kTree, select, take } from "./browser/actions.mjs";

const kCrown = ["sphere bole radius=1.3 center=0,0,3", "sphere side radius=1 center=1.7,0,2.6"];

const kScene = [
    "sphere crown",
    "scale crown 2.2 2.0 2.4",
    "translate crown 0 0 5.2",
    "sphere bough",
    "scale bough 1.6 1.3 1.1",
    "translate bough 2.2 0.6 4.4",
    "blend crown bough crown",
    "pointset generate crown poisson count=1500",
    "grow tree crown root=0,0,0,0,0,1 influence_radius=1.6 kill_radius=0.3 step=0.1",
    "radii tree tip_radius=0.01",
    "tidy tree",
    "mesh tree levels=1",
];

const folder = process.argv[2];
await startBrowser();
const studio = await startStudio();

/** Fewer shades: invisible, and half the size. */
function coarsened(bytes) {
    const picture = PNG.sync.read(bytes);
    picture.data.forEach((value, i) => (picture.data[i] = Math.min(255, Math.round(value / 6) * 6)));
    return PNG.sync.write(picture, { colorType: 2, deflateLevel: 9 });
}

/** Creates a picture of a tab with these lines: of its final state, or of the area right of the tools in its 3D view. */
async function draw(name, lines, show, isWhole = false) {
    const page = await openPage(studio, { viewport: { width: 1200, height: 760 }, colorScheme: "dark", reducedMotion: "reduce" });
    await page.evaluate(() => globalThis.coppice.engine.request("open", { file: "" }));
    await runLines(page, ...lines);
    await show(page);
    await settled(page);
    const { x, y, width, height } = await page.locator(".picture-frame").boundingBox();
    const clip = isWhole ? undefined : { x: x + 0.45 * width, y: y + 50, width: 0.55 * width, height: height - 50 };
    await writeFile(join(folder, name), coarsened(await page.screenshot({ clip })));
    await page.mouse.up();
    await page.context().close();
}

async function hide(page, ...objects) {
    await page.evaluate((all) => (globalThis.coppice.store.hidden.value = new Set(all)), objects);
}

async function look(page, place, radius) {
    await page.evaluate(
        ([at, around]) => {
            globalThis.coppice.view.display.parallel.value = true;
            globalThis.coppice.view.look("front");
            globalThis.coppice.view.frameAround(at, around);
        },
        [place, radius],
    );
    await settled(page);
}

await draw(
    "studio.png",
    kScene,
    async (page) => {
        await hide(page, "points:crown", "solid:bough");
        await page.evaluate(() => globalThis.coppice.view.frame([{ kind: "mesh", name: "tree" }]));
        await select(page, "mesh", "tree");
    },
    true,
);

await draw("studio_crown.png", kCrown, async (page) => {
    await look(page, [-1, 0, 2.2], 3);
    await take(page, "Crown", "Combine");
    await dragIn(
        page,
        [
            [-0.4, 0, 2.8],
            [1.9, 0, 2.7],
        ],
        { steps: 12 },
    );
    await page.getByLabel("3D view").getByRole("button", { name: "Blend", exact: true }).hover();
    await settled(page);
});

await draw("studio_branch.png", kTree, async (page) => {
    await look(page, [-0.8, 0, 1.6], 2.1);
    await take(page, "Branches", "Bend");
    const [from, to] = [await placeOf(page, [1.2, 0, 1.88]), await placeOf(page, [1.1, 0, 2.6])];
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 8 });
});

await endBrowser();
await studio.end();
