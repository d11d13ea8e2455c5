// Interaction with the 3D view: mouse, touch and keyboard actions of the tests of the tools, and the state that they check.
import assert from "node:assert/strict";
import { PNG } from "pngjs";
import { openPage, placeOf, runLines, settled } from "./browser.mjs";
import { until } from "./user.mjs";

/**
 * A tree in the plane y = 0, so that every point is visible from the front: a stem of 3 m (nodes 0 to 18), a branch to the right
 * (19 to 21) and one to the left (22 to 24).
 */
export const kTree = [
    "limb tree 0,0,0 0,0,1 0,0,2 0,0,3 radius=0.12 tip_radius=0.05",
    "edit draw tree 0,0,1 0.5,0,1.4 1,0,1.8 1.5,0,2 radius=0.06",
    "edit draw tree 0,0,2 -0.5,0,2.3 -1,0,2.6 -1.4,0,2.8 radius=0.05",
];

/** A tab with a parallel front view, without animations and with few pixels, since there is no GPU. */
export async function openFront(studio, options = {}) {
    const page = await openPage(studio, { viewport: { width: 1600, height: 900 }, deviceScaleFactor: 0.5, reducedMotion: "reduce", ...options });
    await look(page);
    return page;
}

async function look(page, reach = 2.2) {
    await page.evaluate((radius) => {
        const { view } = globalThis.coppice;
        view.display.shadow.value = false;
        view.display.parallel.value = true;
        view.look("front");
        view.frameAround([-1.1, 0, 1.5], radius); // objects near x = 0 are to the right of the tools
    }, reach);
    await settled(page);
}

/** An empty document in which these lines have been run. */
export async function begin(page, ...lines) {
    await page.evaluate(async () => {
        const { store, engine, take } = globalThis.coppice;
        take("select");
        await engine.request("open", { file: "" });
        store.hidden.value = new Set();
        store.messages.value = [];
        store.selection.value = { object: null, nodes: [], extent: "branch" };
    });
    await runLines(page, ...lines);
    await look(page);
    page.complaints.length = 0;
}

export async function select(page, kind, name, nodes = [], extent = "branch") {
    await page.evaluate(
        (given) => {
            globalThis.coppice.store.selection.value = { object: { kind: given[0], name: given[1] }, nodes: given[2], extent: given[3] };
        },
        [kind, name, nodes, extent],
    );
}

/** Selects a tool by its button, and unfolds its group if necessary. */
export async function take(page, group, label) {
    const heading = page.locator(".tool-heading", { hasText: group });
    if ((await heading.getAttribute("aria-expanded")) === "false") {
        await heading.click();
    }
    await page.getByRole("group", { name: group, exact: true }).getByRole("button", { name: label, exact: true }).click();
    if (group === "Branches") {
        await settled(page); // its tools have received the skeletons then
    }
}

/** Hides all objects: solids have many triangles and are slow to draw without a GPU. */
export async function hideAll(page) {
    await page.evaluate(() => {
        const { hidden, state } = globalThis.coppice.store;
        hidden.value = new Set(state.peek().objects.map(({ kind, name }) => `${kind}:${name}`));
    });
}

export const held = (page) => page.evaluate(() => globalThis.coppice.store.tool.value);
export const selection = (page) => page.evaluate(() => globalThis.coppice.store.selection.value);
export const messagesOf = (page) => page.evaluate(() => globalThis.coppice.store.messages.value.map(({ text }) => text));
export const field = (page, label) =>
    page
        .locator(".tool-panel label")
        .filter({ has: page.getByText(label, { exact: true }) })
        .locator("input, select");
export const button = (page, label) => page.locator(".tool-panel").getByRole("button", { name: label, exact: true });
export const chooseIn = (page, label, value) => field(page, label).selectOption(value);

/** Waits until the last line of the document matches, and returns it. */
export async function lastLine(page, pattern) {
    const fits = ([source]) => {
        const { statements, ran, running } = globalThis.coppice.store.state.peek();
        return running === null && ran === statements.length && new RegExp(source).test(statements.at(-1)?.text ?? "");
    };
    await until(page, `the last line matches ${pattern}`, fits, [pattern.source]);
    return page.evaluate(() => globalThis.coppice.store.state.peek().statements.at(-1).text);
}

/** The numbers of an option, or of a positional word. */
export function numbers(line, word) {
    const text = typeof word === "number" ? line.split(" ")[word] : new RegExp(`\\b${word}=(\\S+)`).exec(line)?.[1];
    assert.ok(text, `${line} has no ${word}`);
    return text.split(",").map(Number);
}

export function near(found, wanted, most, label) {
    const off = Math.max(...wanted.map((value, i) => Math.abs(found[i] - value)));
    assert.ok(off <= most, `${label}: ${found} is not within ${most} of ${wanted}`);
}

/** Waits until the view shows the preview of an object, and not its state in the document. */
export async function untilFollows(page, kind, name, label = "the surface follows the pointer") {
    const follows = ([wanted, called]) => {
        const { view } = globalThis.coppice;
        return ["surface", "curve"].some((form) => view.geometry({ kind: wanted, name: called }, form)?.header.seq !== undefined);
    };
    await until(page, label, follows, [kind, name]);
}

/** Presses at one position of the scene and moves to others, then calls `during` before the button is released. */
export async function dragIn(page, points, { during, keys = [], steps = 5 } = {}) {
    const places = [];
    for (const point of points) {
        places.push(await placeOf(page, point));
    }
    await page.mouse.move(places[0].x, places[0].y);
    await page.mouse.down();
    for (const key of keys) {
        await page.keyboard.down(key);
    }
    for (const place of places.slice(1)) {
        await page.mouse.move(place.x, place.y, { steps });
    }
    await during?.();
    await page.mouse.up();
    for (const key of keys) {
        await page.keyboard.up(key);
    }
}

export async function clickAt(page, point, options) {
    const { x, y } = await placeOf(page, point);
    await page.mouse.click(x, y, options);
}

export async function moveTo(page, point) {
    const { x, y } = await placeOf(page, point);
    await page.mouse.move(x - 2, y);
    await page.mouse.move(x, y);
}

/** Image of the centre of the 3D view, without the elements at its edges. */
export async function picture(page) {
    // While it moves on a slow machine it has fewer pixels.
    await page.waitForFunction(() => !globalThis.coppice.view.isPlainer);
    await settled(page);
    // A drawn frame is on the screen one frame later.
    await page.evaluate(() => new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(next))));
    return pictureNow(page);
}

/** The same while a command is running. */
export async function pictureNow(page) {
    const box = await page.locator(".picture-canvas canvas").boundingBox();
    const clip = { x: box.x + box.width * 0.45, y: box.y + 40, width: box.width * 0.5, height: box.height - 90 };
    return PNG.sync.read(await page.screenshot({ clip }));
}

/** Number of visibly different pixels of two images. */
export function differing(a, b) {
    let count = 0;
    for (let i = 0; i < a.data.length; i += 4) {
        count += [0, 1, 2].some((k) => Math.abs(a.data[i + k] - b.data[i + k]) > 24) ? 1 : 0;
    }
    return count;
}

export function assertDiffer(a, b, label, least = 50) {
    const count = differing(a, b);
    assert.ok(count >= least, `${label}: only ${count} pixels of the image changed`);
}

/** Conditions at the end of every test. */
export async function assertNoErrors(page) {
    assert.deepEqual(page.complaints, [], "the page reports errors");
    const errors = await page.evaluate(() => globalThis.coppice.store.messages.value.filter(({ level }) => level === "error"));
    assert.deepEqual(errors, [], "the studio reports an error");
}
