// From an empty scene to an exported surface with the mouse only, and with touch only; keyboard.test.mjs uses the keyboard.
import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { endBrowser, openPage, placeOf, settled, startBrowser, startStudio } from "./browser.mjs";
import { drag } from "./touches.mjs";
import { assertNoErrors, lastLine, near, numbers } from "./actions.mjs";
import { checkFile, until, untilObject } from "./user.mjs";

let studio;

before(startBrowser);

after(endBrowser);

beforeEach(async () => {
    studio = await startStudio();
});

afterEach(() => studio.end());

const kMouse = {
    options: {},
    press: (locator, options) => locator.click(options),
    drag: async (page, places) => {
        await page.mouse.move(places[0].x, places[0].y);
        await page.mouse.down();
        for (const { x, y } of places.slice(1)) {
            await page.mouse.move(x, y, { steps: 5 });
        }
        await page.mouse.up();
    },
};
const kTouch = { options: { hasTouch: true }, press: (locator, options) => locator.tap(options), drag };

/** The position in the page of the tip of a branch that is not occluded. */
async function openTip(page, name) {
    await settled(page);
    const found = await page.evaluate((tree) => {
        const { view } = globalThis.coppice;
        const { arrays, header } = view.geometry({ kind: "skeleton", name: tree }, "skeleton");
        const parents = new Set(arrays.parent);
        for (let n = 0; n < arrays.id.length; ++n) {
            const at = [0, 1, 2].map((k) => arrays.position[3 * n + k] + header.origin[k]);
            const [x, y] = view.toPixels(at);
            const { left, top } = view.element().getBoundingClientRect();
            const isOpen = document.elementFromPoint(left + x, top + y) === view.element(); // tools cover a part of the view
            if (isOpen && !parents.has(n) && view.pick(x, y)?.node === arrays.id[n]) {
                return at;
            }
        }
        return null;
    }, name);
    assert.ok(found, "some branch is visible");
    return placeOf(page, found);
}

async function runWorkflow(input) {
    const page = await openPage(studio, { viewport: { width: 1280, height: 800 }, deviceScaleFactor: 0.5, reducedMotion: "reduce", ...input.options });
    await page.evaluate(() => {
        globalThis.coppice.view.display.shadow.value = false;
        globalThis.used = [];
        for (const type of ["keydown", "pointerdown"]) {
            addEventListener(type, (event) => globalThis.used.push(event.pointerType ?? event.key), true);
        }
    });
    const tap = (name, within = page) => input.press(within.getByRole("button", { name, exact: true }));
    const tools = page.getByRole("toolbar", { name: "Tools" });

    await tap("Place", tools);
    await input.drag(page, [await placeOf(page, [0, 0, 0]), await placeOf(page, [1.2, 0, 0])]);
    near(numbers(await lastLine(page, /^sphere ball /), "radius"), [1.2], 0.1, "as wide as it was drawn");
    await tap("Move", tools);
    await settled(page);
    const high = await page.evaluate(() => 70 * globalThis.coppice.view.pixelSize([0, 0, 0]));
    await input.drag(page, [await placeOf(page, [0, 0, high]), await placeOf(page, [0, 0, high + 2])]);
    near((await lastLine(page, /^translate ball /)).split(" ").slice(2).map(Number), [0, 0, 2], 0.1, "up along the arrow");

    await tap("Fill ball with points");
    await untilObject(page, "points", "ball");
    const slider = page.locator(".side.right").getByRole("slider", { name: /count/i });
    const { width, height } = await slider.boundingBox();
    await input.press(slider, { position: { x: 0.25 * width, y: height / 2 } });
    const fewer = await lastLine(page, /^pointset .* count=(?!2000)/);
    assert.ok(numbers(fewer, "count")[0] < 600, `to the left on its slider are fewer points: ${fewer}`);
    await tap("Grow a tree");
    await untilObject(page, "skeleton", "tree");
    await tap("Bend", tools);
    const { x, y } = await openTip(page, "tree");
    await input.drag(page, [
        { x, y },
        { x: x + 40, y },
    ]);
    await lastLine(page, /^edit bend tree /);
    await tap("Make the surface");
    await untilObject(page, "mesh", "tree");

    await input.press(page.locator(".menu-title", { hasText: /^File$/ }));
    await input.press(page.getByText("Export…", { exact: true }));
    const dialog = page.getByRole("dialog", { name: "Export", exact: true });
    await tap("Export", dialog);
    await until(page, "it is written and checked", () => document.querySelector("dialog[open] .verdict.good"));
    await tap("Close", page.getByRole("dialog"));
    await checkFile(studio, "tree.glb");
    await assertNoErrors(page);
    return page.evaluate(() => [...new Set(globalThis.used)]);
}

test("the workflow is possible with the mouse only", async () => {
    assert.deepEqual(await runWorkflow(kMouse), ["mouse"]);
});

test("the workflow is possible by touch only", async () => {
    assert.deepEqual(await runWorkflow(kTouch), ["touch"]);
});
