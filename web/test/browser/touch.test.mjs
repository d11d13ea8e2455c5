// Touch: the view is rotated, moved and zoomed, objects are picked, placed, bent and drawn.
import assert from "node:assert/strict";
import { test } from "node:test";
import { lines, placeOf, settled, withStudio } from "./browser.mjs";
import { down, drag, moveFinger, pinch, tapAt, up } from "./touches.mjs";
import { assertNoErrors, assertDiffer, begin, field, held, kTree, lastLine, near, numbers, openFront, picture, selection, untilFollows } from "./actions.mjs";
import { until, untilSelected } from "./user.mjs";

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openFront(studio, { hasTouch: true, viewport: { width: 1280, height: 760 } });
    await page.evaluate(() => {
        globalThis.pointers = new Set();
        globalThis.touches = [];
        addEventListener("pointerdown", (event) => globalThis.pointers.add(event.pointerType), true);
        for (const type of ["pointerdown", "pointerup", "pointercancel", "contextmenu", "click"]) {
            addEventListener(
                type,
                ({ target, timeStamp }) => globalThis.touches.push(`${type} on ${target.className || target.tagName} at ${Math.round(timeStamp)}`),
                true,
            );
        }
    });
});

const kOnRight = [0.9, 0, 1.72]; // on the segment that leads to node 20
const places = (...points) => Promise.all(points.map((point) => placeOf(page, point)));
const dragIn = async (points, options) => drag(page, await places(...points), options);
const tapIn = async (point) => tapAt(page, await placeOf(page, point));
const pose = () =>
    page.evaluate(() => {
        const { yaw, pitch, distance } = globalThis.coppice.view.rig.pose;
        return { yaw, pitch, distance };
    });

/** Selects a tool by taps. */
async function take(group, label) {
    const heading = page.locator(".tool-heading", { hasText: group });
    if ((await heading.getAttribute("aria-expanded")) === "false") {
        await heading.tap();
    }
    const tool = page.getByRole("group", { name: group, exact: true }).getByRole("button", { name: label, exact: true });
    await tool.tap();
    try {
        await tool.and(page.locator("[aria-pressed=true]")).waitFor(); // browsers convert a tap to a click with a delay
    } catch (error) {
        error.message += `\nThe last events: ${await page.evaluate(() => globalThis.touches.slice(-8).join(", "))}`;
        throw error;
    }
    await settled(page);
}

function nearPlace(found, wanted, label) {
    near([found.x, found.y], [wanted.x, wanted.y], 3, label);
}

test("one finger rotates the view, two fingers pan and zoom it", async () => {
    await begin(page, ...kTree);
    const before = await pose();
    const { x, y } = await placeOf(page, [0.5, 0, 0.6]); // away from the tree
    await drag(page, [
        { x, y },
        { x: x + 100, y: y + 30 },
    ]);
    const turned = await pose();
    assert.ok(Math.abs(turned.yaw - before.yaw) > 0.3 && turned.pitch > before.pitch + 0.1, `it turned: ${JSON.stringify([before, turned])}`);
    assert.equal(turned.distance, before.distance, "and did not zoom");

    await begin(page, ...kTree);
    const [low, high] = await places([0.6, 0, 0.9], [0.6, 0, 2.1]);
    const aside = ({ x, y }) => ({ x: x - 60, y: y + 40 });
    const [tip] = await places([1.5, 0, 2]);
    await pinch(page, [low, high], [aside(low), aside(high)]);
    nearPlace(await placeOf(page, [1.5, 0, 2]), aside(tip), "the view follows the fingers");
    assert.deepEqual(await pose(), before, "the camera only moves");

    await begin(page, ...kTree);
    const nearer = await picture(page);
    const middle = { x: (low.x + high.x) / 2, y: (low.y + high.y) / 2 };
    const apart = (share) => [low, high].map(({ x, y }) => ({ x: middle.x + (x - middle.x) * share, y: middle.y + (y - middle.y) * share }));
    await pinch(page, [low, high], apart(1.6));
    nearPlace(await placeOf(page, [0.6, 0, 1.5]), middle, "the point between the fingers stays there");
    for (const [n, point] of [
        [0.6, 0, 0.9],
        [0.6, 0, 2.1],
    ].entries()) {
        nearPlace(await placeOf(page, point), apart(1.6)[n], "and the points under them follow them");
    }
    assertDiffer(await picture(page), nearer, "the tree is larger");
    await pinch(page, apart(1.6), [low, high]);
    near([(await pose()).distance], [before.distance], before.distance * 0.02, "and back");
    assert.deepEqual(await lines(page), kTree, "the tree is unchanged");
    await assertNoErrors(page);
});

test("a tap selects, a long press shows the object, and a tap on the background deselects", async () => {
    await begin(page, ...kTree);
    await tapIn(kOnRight);
    assert.deepEqual(await selection(page), { object: { kind: "skeleton", name: "tree" }, nodes: [20], extent: "branch" });
    await tapIn([-1.6, 0, 1]);
    assert.equal((await selection(page)).object, null);
    await down(page, await placeOf(page, [-0.9, 0, 2.54]));
    await until(page, "the resting finger finds node 23", () => globalThis.coppice.store.hover.value?.node === 23);
    await up(page);
    assert.equal((await selection(page)).object, null, "looking is not picking");
    await assertNoErrors(page);
});

test("solids are placed and moved by a finger, and undone by the button", async () => {
    await begin(page);
    await page.evaluate(() => globalThis.coppice.view.look("top"));
    await take("Crown", "Place");
    await dragIn(
        [
            [0.4, 0, 0],
            [0.9, 0, 0],
        ],
        { during: () => untilFollows(page, "solid", "ball") },
    );
    const line = await lastLine(page, /^sphere /);
    near(numbers(line, "center"), [0.4, 0, 0], 0.02, line);
    near(numbers(line, "radius"), [0.5], 0.02, line);
    await field(page, "Shape").selectOption("box");
    await dragIn([
        [-0.8, 0.5, 0],
        [-0.5, 0.5, 0],
    ]);
    const box = await lastLine(page, /^box /);
    near(numbers(box, "high"), [-0.53, 0.77, 0.57], 0.05, `as high as it is wide, since fingers do not hover: ${box}`);

    await untilSelected(page, "solid", "box");
    await take("View", "Move");
    const reach = await page.evaluate(() => 70 * globalThis.coppice.view.pixelSize([-0.8, 0.5, 0.3]));
    await dragIn([
        [-0.8 + reach, 0.5, 0.3],
        [-0.3 + reach, 0.9, 0.3],
    ]);
    near((await lastLine(page, /^translate box /)).split(" ").slice(2).map(Number), [0.5, 0, 0], 0.03, "along the arrow alone");
    const undo = page.getByRole("button", { name: /^Undo/ });
    await undo.tap();
    await undo.tap();
    await until(page, "two steps back", () => globalThis.coppice.store.state.peek().statements.length === 1);
    await page.getByRole("button", { name: /^Redo/ }).tap();
    assert.equal(await lastLine(page, /^box /), box, "and one forth");
    await assertNoErrors(page);
});

test("branches are bent and drawn by a finger; a second finger pans the view instead", async () => {
    await begin(page, ...kTree);
    await take("Branches", "Bend");
    await dragIn([kOnRight, [0.9, 0, 1.32]], { during: () => untilFollows(page, "skeleton", "tree", "the surface follows the finger") });
    near(numbers(await lastLine(page, /^edit bend tree at\(/), "towards"), [0, 0, -1], 0.05, "down");

    await take("Branches", "Draw");
    await dragIn(
        [
            [0, 0, 2.5],
            [0.3, 0, 2.8],
            [0.7, 0, 2.9],
        ],
        { during: () => untilFollows(page, "skeleton", "tree") },
    );
    const line = await lastLine(page, /^edit draw tree /);
    near(numbers(line, 3), [0, 0, 2.5], 0.05, "it begins on the stem");
    near(line.split(" ").at(-1).split(",").map(Number), [0.7, 0, 2.9], 0.1, "and ends where the finger was lifted");

    const all = await lines(page);
    const before = await pose();
    const from = await places([0, 0, 1.5], [1, 0, 1.5]);
    const to = await places([-0.3, 0, 1.5], [1.3, 0, 1.5]);
    await down(page, from[0]);
    await moveFinger(page, [from[0]], [{ x: from[0].x, y: from[0].y - 40 }]);
    await down(page, { x: from[0].x, y: from[0].y - 40 }, from[1]);
    await moveFinger(page, [{ x: from[0].x, y: from[0].y - 40 }, from[1]], to);
    await up(page);
    await settled(page);
    assert.deepEqual(await lines(page), all, "the operation of the first finger is undone");
    assert.ok((await pose()).distance < before.distance * 0.8, "the view was zoomed");
    assert.equal(await held(page), "draw", "and the tool is still active");
    await assertNoErrors(page);
});

test("handles of a section, menus and lists respond to taps", async () => {
    await begin(page, "sphere crown radius=0.8 center=0,0,1.5");
    await page.locator(".menu-title", { hasText: /^Crown$/ }).tap();
    await page.locator(".menu-item", { hasText: "Ball of 2 m" }).tap();
    await lastLine(page, /^sphere crown2 radius=2/);
    await page.getByRole("treeitem", { name: /^crown2/ }).tap();
    await untilSelected(page, "solid", "crown2");
    await page.evaluate(() => {
        globalThis.coppice.view.display.section.value = { on: true, axis: "x", at: 0, flipped: false };
    });
    await page.getByRole("button", { name: "Frame", exact: true }).tap();
    await settled(page);
    const handle = await page.evaluate(() => globalThis.coppice.view.section.middle.toArray());
    await dragIn([handle, [handle[0] + 0.4, handle[1], handle[2]]]);
    near([await page.evaluate(() => globalThis.coppice.view.display.section.value.at)], [0.4], 0.03, "the section followed the finger");
    await page.evaluate(() => {
        const { section } = globalThis.coppice.view.display;
        section.value = { ...section.value, on: false };
    });
    assert.deepEqual(await page.evaluate(() => [...globalThis.pointers]), ["touch"], "no mouse was used");
    await assertNoErrors(page);
});
