// Interactive sketches: a known fork, photographed twice, is drawn over its images and reconstructed.
import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { PNG } from "pngjs";
import { drag, lines, runLines, settled, withStudio } from "./browser.mjs";
import { assertNoErrors, assertDiffer, begin, button, field, lastLine, near, openFront, picture, take } from "./actions.mjs";
import { coppice, until } from "./user.mjs";

const kWide = 360,
    kHigh = 480; // [px] size of the images
const kAngle = 45; // [degree] vertical field of view
const kFocal = (0.5 * kHigh) / Math.tan((kAngle * Math.PI) / 360);
const kFork = {
    // [m]: axes, and the radii at their ends
    stem: {
        points: [
            [0, 0, 0],
            [0.06, -0.05, 1.2],
            [0, 0, 2.6],
        ],
        radii: [0.1, 0.04],
    },
    lateral: {
        points: [
            [0.06, -0.05, 1.2],
            [0.4, 0.25, 1.7],
            [0.55, 0.5, 2.2],
        ],
        radii: [0.06, 0.025],
    },
};
// Cameras in the convention of OpenCV: both level, 4 m and 4.5 m from the stem, 1.3 m above its base.
const kCameras = {
    front: {
        R: [
            [1, 0, 0],
            [0, 0, -1],
            [0, 1, 0],
        ],
        t: [0, 1.3, 4],
    },
    side: {
        R: [
            [0, 1, 0],
            [0, 0, -1],
            [-1, 0, 0],
        ],
        t: [0, 1.3, 4.5],
    },
};
const kViews = Object.keys(kCameras);

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openFront(studio);
    for (const view of kViews) {
        await studio.write(`${view}.png`, photograph(view));
    }
});

/** The pixel of a point in a view, and the number of pixels per metre there. */
function seen(view, point) {
    const { R, t } = kCameras[view];
    const [x, y, depth] = R.map((row, k) => row.reduce((sum, value, i) => sum + value * point[i], t[k]));
    return { at: [kWide / 2 + (kFocal * x) / depth, kHigh / 2 + (kFocal * y) / depth], scale: kFocal / depth };
}

/** Many points along an axis of the fork, with radii. */
function along({ points, radii }, pieces = 60) {
    const parts = points.slice(1).map((to, i) => [points[i], to]);
    return parts.flatMap(([from, to], i) =>
        Array.from({ length: pieces + 1 }, (_, k) => {
            const share = (i + k / pieces) / parts.length;
            return { at: from.map((value, c) => value + ((to[c] - value) * k) / pieces), radius: radii[0] + (radii[1] - radii[0]) * share };
        }),
    );
}

/** An image of the fork in front of a bright sky. */
function photograph(view) {
    const png = new PNG({ width: kWide, height: kHigh });
    png.data.fill(235);
    for (const axis of Object.values(kFork)) {
        for (const { at, radius } of along(axis)) {
            const {
                at: [x, y],
                scale,
            } = seen(view, at);
            const reach = radius * scale;
            for (let row = Math.ceil(y - reach); row <= y + reach; ++row) {
                for (let column = Math.ceil(x - reach); column <= x + reach; ++column) {
                    if (Math.hypot(column - x, row - y) <= reach && row >= 0 && row < kHigh) {
                        png.data.set([70, 50, 40, 255], 4 * (row * kWide + column));
                    }
                }
            }
        }
    }
    return PNG.sync.write(png);
}

const pane = (view) => page.locator(".sketch-pane").filter({ hasText: view }).locator("canvas");

/** The position in the page of a pixel of an image: images fill their panes. */
async function onPage(view, [x, y]) {
    const box = await pane(view).boundingBox();
    const scale = Math.min(box.width / kWide, box.height / kHigh);
    return { x: box.x + (box.width - kWide * scale) / 2 + x * scale, y: box.y + (box.height - kHigh * scale) / 2 + y * scale, scale };
}

/** Draws an axis of the fork in a view, with its width. */
async function draw(view, axis) {
    const wide = page.getByLabel("Width of strokes [px]");
    await wide.fill(String(Math.round(2 * axis.radii[0] * seen(view, axis.points[0]).scale)));
    await wide.press("Tab");
    await drag(page, await Promise.all(along(axis, 3).map(({ at }) => onPage(view, seen(view, at).at))), 2);
}

/** The fields of a view, by their labels. */
async function openView(view) {
    const form = page.locator(".sketch-view").filter({ has: page.locator("summary", { hasText: `View ${view}` }) });
    if (!(await form.evaluate((element) => element.open))) {
        await form.locator("summary").click();
    }
    return (label) =>
        form
            .locator("label")
            .filter({ has: page.getByText(label, { exact: true }) })
            .locator("input, select");
}

const least = (point, others) => Math.min(...others.map((other) => Math.hypot(...point.map((value, k) => value - other[k]))));

/** Points along all segments. */
function between(nodes) {
    return nodes.flatMap(({ at, parent }) => {
        const from = parent < 0 ? at : nodes[parent].at;
        return Array.from({ length: 21 }, (_, k) => from.map((value, c) => value + ((at[c] - value) * k) / 20));
    });
}

/** The tree equals the fork in position, extent and thickness. */
function assertFork(nodes, most) {
    const truth = Object.values(kFork).flatMap((axis) => along(axis, 20));
    const axes = truth.map(({ at }) => at);
    const found = between(nodes);
    const missed = Math.max(...axes.map((at) => least(at, found)));
    const astray = Math.max(...found.map((at) => least(at, axes)));
    assert.ok(missed <= most, `${missed} m of the fork are missing`);
    assert.ok(astray <= most, `the tree is ${astray} m away from the fork`);
    for (const { points, radii } of Object.values(kFork)) {
        const tip = nodes.find(({ at }) => least(at, [points.at(-1)]) <= most);
        assert.ok(tip && Math.abs(tip.radius - radii[1]) < 0.5 * radii[1], `the tip is ${tip?.radius} m thick, not ${radii[1]}`);
    }
    const foot = nodes.find(({ parent }) => parent < 0);
    assert.ok(Math.abs(foot.radius - kFork.stem.radii[0]) < 0.15 * kFork.stem.radii[0], `the base is ${foot.radius} m thick`);
}

async function nodesOf(name) {
    await settled(page);
    return page.evaluate((tree) => {
        const { arrays, header } = globalThis.coppice.view.geometry({ kind: "skeleton", name: tree }, "skeleton");
        const { position, radius, parent } = arrays;
        const at = (n) => [0, 1, 2].map((k) => position[3 * n + k] + header.origin[k]);
        return Array.from(radius, (r, n) => ({ at: at(n), radius: r, parent: parent[n] === 0xffffffff ? -1 : parent[n] }));
    }, name);
}

/** Waits until a tree with this maximum height is shown with the images, before it is in the scene. */
const untilHeight = (height, label) =>
    until(
        page,
        label,
        ([wanted]) => {
            const tree = globalThis.coppice.view.overlay.children.find((one) => one.isInstancedMesh);
            const all = tree?.instanceMatrix.array ?? [];
            const tops = Array.from({ length: all.length / 16 }, (_, i) => all[16 * i + 14] + Math.abs(all[16 * i + 6]) / 2);
            return wanted === null ? !tree : Math.abs(Math.max(...tops) - wanted) < 0.08;
        },
        [height],
    );

async function pixelsOf(view) {
    await settled(page);
    return PNG.sync.read(await pane(view).screenshot({ scale: "css" }));
}

/** Number of pixels within `reach` of a position in the image of a pane that have the blue of lines of sight. */
function blueAround(png, [x, y], reach) {
    let count = 0;
    for (let row = Math.max(y - reach, 0); row <= Math.min(y + reach, png.height - 1); ++row) {
        for (let column = Math.max(x - reach, 0); column <= Math.min(x + reach, png.width - 1); ++column) {
            const [red, , blue] = png.data.subarray(4 * (Math.round(row) * png.width + Math.round(column)));
            count += blue > red + 70 ? 1 : 0;
        }
    }
    return count;
}

async function takeSketch() {
    await begin(page);
    await take(page, "Branches", "Sketch");
    assert.equal(await page.locator(".sketch-pane").count(), 2);
}

async function putIntoScene() {
    await button(page, "Add to the scene").click();
    await until(page, "the sketch is closed", () => globalThis.coppice.store.tool.peek() === "select");
    assert.equal(await page.locator(".sketch-pane").count(), 0);
}

test("a fork is drawn over two photographs and reconstructed immediately", async () => {
    await takeSketch();
    for (const view of kViews) {
        const at = await openView(view);
        await at("Kind").selectOption({ label: "Photograph, level" });
        await at("Taken from").selectOption(view);
        await at("Field of view [°]").fill(String(kAngle));
        await at("Field of view [°]").press("Tab");
        await at("Image").selectOption(`${view}.png`);
    }
    await field(page, "Height of the tree [m], 0 = from the scale").fill("2.6");
    const empty = await picture(page);
    for (const [name, axis] of Object.entries(kFork)) {
        for (const view of kViews) {
            await draw(view, axis);
        }
        await untilHeight(2.6, `the ${name} is shown with its images`);
    }
    assertDiffer(await picture(page), empty, "the tree is drawn");
    assert.deepEqual(await lines(page), [], "the scene does not contain it before it is added");
    await button(page, "Undo stroke").click();
    await button(page, "Undo stroke").click();
    await button(page, "Undo stroke").click();
    await untilHeight(null, "a stem in one view is not a tree");
    await button(page, "Redo stroke").click();
    await button(page, "Redo stroke").click();
    await button(page, "Redo stroke").click();
    await untilHeight(2.6, "it is restored");

    await field(page, "Tree").fill("fork");
    await putIntoScene();
    assert.equal(await lastLine(page, /^sketch /), "sketch fork fork.sketch.json");
    assertFork(await nodesOf("fork"), 0.015);

    // The scene creates the same tree without the page.
    await runLines(page, "save fork studio.swc");
    await studio.write("fork.coppice", (await lines(page))[0]);
    const again = join(studio.folder, "again.swc");
    const { code, text } = await coppice("run", join(studio.folder, "fork.coppice"), "-o", again);
    assert.equal(code, 0, text);
    assert.deepEqual(await studio.read("again.swc"), await studio.read("studio.swc"), "bit-identical");
    await assertNoErrors(page);
});

test("a changed stroke updates the tree of the scene and the objects made of it", async () => {
    await take(page, "Branches", "Sketch");
    await field(page, "Open").selectOption("fork.sketch.json");
    await untilHeight(2.6, "the sketch is opened");
    const tip = kFork.lateral.points.at(-1);
    for (const view of kViews) {
        const {
            at: [x, y],
        } = seen(view, tip);
        const { x: px, y: py } = await onPage(view, [x, y]);
        await page.mouse.click(...Object.values(await onPage(view, seen(view, kFork.lateral.points[1]).at)).slice(0, 2));
        assert.equal(await field(page, "Branch").inputValue(), "branch 1", "a click chooses the stroke");
        const to = await onPage(view, seen(view, [tip[0], tip[1], 2.4]).at);
        await drag(page, [{ x: px, y: py }, to], 3);
    }
    await settled(page);
    await putIntoScene();
    assert.deepEqual(await lines(page), ["sketch fork fork.sketch.json", "save fork studio.swc"], "no additional line");
    await until(
        page,
        "the tip is higher",
        ([x, y]) => {
            const { view, store } = globalThis.coppice;
            const found = view.geometry({ kind: "skeleton", name: "fork" }, "skeleton");
            const places = Array.from({ length: found?.arrays.radius.length ?? 0 }, (_, n) => found.arrays.position.subarray(3 * n, 3 * n + 3));
            return store.state.peek().running === null && places.some((at) => Math.hypot(at[0] - x, at[1] - y, at[2] - 2.4) < 0.08);
        },
        tip,
    );
    await assertNoErrors(page);
});

test("calibrated cameras show the epipolar line of a point, and silhouettes propose strokes", async () => {
    await takeSketch();
    for (const view of kViews) {
        const at = await openView(view);
        await at("Image").selectOption(`${view}.png`);
        await at("Kind").selectOption({ label: "Calibrated camera" });
        const { R, t } = kCameras[view];
        await at("K, rows with ;").fill(`${kFocal} 0 ${kWide / 2}; 0 ${kFocal} ${kHigh / 2}; 0 0 1`);
        await at("R, rows with ;").fill(R.map((row) => row.join(" ")).join("; "));
        await at("t [m]").fill(t.join(" "));
        await at("t [m]").press("Tab");
    }
    await draw("front", kFork.stem);
    for (const point of [kFork.lateral.points[2], kFork.stem.points[2]]) {
        const place = await onPage("front", seen("front", point).at);
        await page.mouse.move(place.x - 3, place.y);
        await page.mouse.move(place.x, place.y);
        const box = await pane("side").boundingBox();
        const shown = await onPage("side", seen("side", point).at);
        const at = [shown.x - box.x, shown.y - box.y];
        let found = 0;
        for (let n = 0; n < 20 && found === 0; ++n) {
            found = blueAround(await pixelsOf("side"), at, 8);
        }
        assert.ok(found > 0, "the line leads through the point");
        assert.equal(blueAround(await pixelsOf("side"), [at[0], at[1] + 60], 20), 0, "and not next to it");
    }
    await page.mouse.move(5, 5);

    await button(page, "Trace the images").click();
    await untilHeight(2.6, "strokes are proposed, and their tree is shown");
    await field(page, "Tree").fill("traced");
    await putIntoScene();
    assert.equal(await lastLine(page, /^sketch /), "sketch traced traced.sketch.json");
    assertFork(await nodesOf("traced"), 0.15);
    await assertNoErrors(page);
});

test("strokes are drawn with the keyboard", async () => {
    await takeSketch();
    for (const view of kViews) {
        await pane(view).focus();
        await page.keyboard.press("ArrowDown"); // the cross is in the centre of 800 pixels
        for (let n = 0; n < 3; ++n) {
            await page.keyboard.press("Alt+ArrowDown"); // at the origin, with steps of a metre
        }
        await page.keyboard.press(" ");
        for (let n = 0; n < 2; ++n) {
            await page.keyboard.press("Alt+ArrowUp");
        }
        await page.keyboard.press(" ");
        await page.keyboard.press("Alt+ArrowUp");
        await page.keyboard.press("Enter");
    }
    await untilHeight(2, "the stem is shown");
    await putIntoScene();
    const nodes = await nodesOf("tree");
    near(nodes[0].at, [0, 0, 0], 0.02, "its foot");
    near(nodes.at(-1).at, [0, 0, 2], 0.02, "its tip");
    await assertNoErrors(page);
});
