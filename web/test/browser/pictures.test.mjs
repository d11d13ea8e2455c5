// Pixel tests of the view: against geometry, against the path tracer, and against itself. No reference images are stored, since
// drivers differ slightly.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { PNG } from "pngjs";
import { openPage, runLines, settled, withStudio } from "./browser.mjs";
import { assertNoErrors, begin } from "./actions.mjs";
import { chooseItem, dialog, until } from "./user.mjs";

const kCenter = [0.2, 0, 1.5];
const kBall = "sphere ball radius=0.8 center=0.2,0,1.5";
// A tapering stem, a branch on it and a twig on the branch, all in the plane y = 0, so that each point is visible from the front.
const kTree = [
    "limb tree 0,0,0 0,0,1 0,0,2 0,0,3 radius=0.2 tip_radius=0.04",
    "edit draw tree 0,0,1 0.5,0,1.3 1,0,1.6 1.4,0,1.8 radius=0.1 tip_radius=0.05",
    "edit draw tree 1,0,1.6 1.1,0,2 1.1,0,2.4 1.1,0,2.8 radius=0.05 tip_radius=0.03",
];
const kSeen = 24; // [of 255] minimum difference of a changed pixel

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openPage(studio, { viewport: { width: 1180, height: 760 }, reducedMotion: "reduce", colorScheme: "dark" });
});

beforeEach(async () => {
    await begin(page);
    await page.evaluate(() => {
        const { display } = globalThis.coppice.view;
        display.grid.value = false;
        display.color.value = "plain";
        for (const name of ["wireframe", "bones", "cage"]) {
            display[name].value = false;
        }
        for (const name of ["section", "slice"]) {
            display[name].value = { ...display[name].value, on: false };
        }
    });
});

/** Sets signals of the display, and waits until they are drawn. */
async function display(settings) {
    await page.evaluate((given) => {
        for (const [name, value] of Object.entries(given)) {
            globalThis.coppice.view.display[name].value = value;
        }
    }, settings);
    await settled(page);
}

/** The image drawn by the view, without the elements over it. */
async function drawn() {
    await settled(page);
    await until(page, "the camera is at rest", () => !globalThis.coppice.view.isTurning); // a moving view may be drawn in a simpler form
    const url = await page.evaluate(() => {
        const { view } = globalThis.coppice;
        view.draw(0); // the previous frame is on the screen and no longer in the canvas
        return view.element().toDataURL();
    });
    return PNG.sync.read(Buffer.from(url.split(",")[1], "base64"));
}

/** The image without any object. */
async function drawnEmpty() {
    await hide((object) => object);
    const empty = await drawn();
    await hide(() => null);
    return empty;
}

async function hide(which) {
    const all = await page.evaluate(() => globalThis.coppice.store.state.value.objects.map(({ kind, name }) => `${kind}:${name}`));
    await page.evaluate((hidden) => {
        globalThis.coppice.store.hidden.value = new Set(hidden);
    }, all.map(which).filter(Boolean));
}

/** Mask of the pixels that differ between two images: a byte for each. */
function changes(a, b, least = kSeen) {
    const out = new Uint8Array(a.width * a.height);
    for (let i = 0; i < out.length; ++i) {
        out[i] = [0, 1, 2].some((k) => Math.abs(a.data[4 * i + k] - b.data[4 * i + k]) > least) ? 1 : 0;
    }
    return Object.assign(out, { width: a.width, height: a.height });
}

const count = (mask) => mask.reduce((sum, value) => sum + value, 0);
const toPixels = (points) => page.evaluate((all) => all.map((point) => globalThis.coppice.view.toPixels(point)), points);

/** The bounding box of pixels: left, top, right and bottom, the last two exclusive. */
function boxOf(mask) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    mask.forEach((value, i) => {
        if (value) {
            const [x, y] = [i % mask.width, Math.floor(i / mask.width)];
            box[0] = Math.min(box[0], x);
            box[1] = Math.min(box[1], y);
            box[2] = Math.max(box[2], x + 1);
            box[3] = Math.max(box[3], y + 1);
        }
    });
    return box;
}

const anyNear = (mask, x, y, reach) => {
    for (let row = Math.floor(y - reach); row <= y + reach; ++row) {
        for (let column = Math.floor(x - reach); column <= x + reach; ++column) {
            if (row >= 0 && column >= 0 && row < mask.height && column < mask.width && mask[row * mask.width + column]) {
                return true;
            }
        }
    }
    return false;
};

/**
 * Every pixel of a mask is close to one of these lines or points (pixels), and the lines are visible along at least `share` of
 * their length.
 */
function assertAlong(mask, lines, { reach, share, label }) {
    assert.ok(count(mask) > 50, `${label}: only ${count(mask)} pixels are drawn`);
    const expected = Object.assign(new Uint8Array(mask.length), { width: mask.width, height: mask.height });
    let seen = 0;
    let all = 0;
    for (const [[ax, ay], [bx, by]] of lines) {
        const steps = Math.max(Math.ceil(Math.hypot(bx - ax, by - ay)), 1);
        for (let n = 0; n <= steps; ++n) {
            const [x, y] = [ax + ((bx - ax) * n) / steps, ay + ((by - ay) * n) / steps];
            ++all;
            seen += anyNear(mask, x, y, 1.5) ? 1 : 0;
            for (let row = Math.floor(y - reach); row <= y + reach; ++row) {
                for (let column = Math.floor(x - reach); column <= x + reach; ++column) {
                    if (row >= 0 && column >= 0 && row < mask.height && column < mask.width) {
                        expected[row * mask.width + column] = 1;
                    }
                }
            }
        }
    }
    assert.ok(seen >= share * all, `${label}: only ${seen} of ${all} points are drawn`);
    const astray = mask.reduce((sum, value, i) => sum + (value && !expected[i] ? 1 : 0), 0);
    assert.ok(astray <= 0.005 * count(mask), `${label}: ${astray} pixels of ${count(mask)} are drawn elsewhere`);
}

test("the silhouette of a ball is a disc of correct size and position, with and without perspective", async () => {
    await runLines(page, kBall);
    for (const parallel of [true, false]) {
        await display({ parallel });
        const mask = changes(await drawn(), await drawnEmpty(), 10);
        const [[x, y]] = await toPixels([kCenter]);
        const radius = await page.evaluate(
            ([center, isParallel]) => {
                const { view } = globalThis.coppice;
                const flat = 0.8 / view.pixelSize(center);
                const far = Math.hypot(...view.rig.pose.eye.toArray().map((value, k) => value - center[k]));
                return isParallel ? flat : flat / Math.sqrt(1 - (0.8 / far) ** 2); // of a close ball more than half the width is hidden
            },
            [kCenter, parallel],
        );
        const box = boxOf(mask);
        [x - radius, y - radius, x + radius, y + radius].forEach((wanted, k) => {
            assert.ok(Math.abs(box[k] - wanted) < 2, `it extends over ${box} instead of ${wanted}`);
        });
        const area = Math.PI * radius ** 2;
        assert.ok(Math.abs(count(mask) / area - 1) < 0.02, `${count(mask)} pixels are not a disc of ${area}`);
    }
    await assertNoErrors(page);
});

/** The visible colours of the legend, from its low to its high end. */
async function legend() {
    await page.locator(".legend-bar").waitFor();
    const { low, high } = await page.evaluate(() => globalThis.coppice.view.display.legend.value);
    const css = await page.locator(".legend-bar").evaluate((bar) => getComputedStyle(bar).backgroundImage);
    const stops = [...css.matchAll(/rgb\((\d+), (\d+), (\d+)\)/g)].map((match) => match.slice(1).map(Number));
    assert.ok(stops.length > 2, `${css} is not a legend`);
    return (value) => {
        const at = Math.min(Math.max((value - low) / (high - low), 0), 1) * (stops.length - 1);
        const k = Math.min(Math.floor(at), stops.length - 2);
        return stops[k].map((part, c) => part + (stops[k + 1][c] - part) * (at - k));
    };
}

/** The angle [degree] between two colours: shading changes it little. */
function apart(a, b) {
    const dot = a.reduce((sum, part, c) => sum + part * b[c], 0);
    return (Math.acos(Math.min(dot / (Math.hypot(...a) * Math.hypot(...b) || 1), 1)) * 180) / Math.PI;
}

/** Points of a surface that face the camera and are not occluded, with their coloured values. */
async function valuesSeen(kind) {
    return page.evaluate((wanted) => {
        const { view } = globalThis.coppice;
        const { arrays, header } = view.geometry({ kind: wanted, name: "tree" }, "surface");
        const out = [];
        for (let v = 0; v < arrays.value.length; ++v) {
            const [x, y] = view.toPixels([0, 1, 2].map((k) => arrays.position[3 * v + k] + header.origin[k]));
            if (arrays.normal[4 * v + 1] < -100) {
                // towards the camera, which looks along +Y
                out.push({ x, y, value: arrays.value[v] });
            }
        }
        return out;
    }, kind);
}

test("colours by radius, order and deviation match the legend", async () => {
    await runLines(page, ...kTree);
    for (const [color, lowest, highest, most] of [
        ["radius", 0.03, 0.19, 25],
        ["order", 0, 2, 25],
        ["deviation", 0, 0, 8],
    ]) {
        await display({ color });
        const png = await drawn();
        const colorOf = await legend();
        const seen = await valuesSeen("skeleton");
        assert.ok(seen.length > 20, `${color}: ${seen.length} points are visible`);
        const values = seen.map(({ value }) => value);
        assert.ok(Math.min(...values) <= lowest + 1e-6 && Math.max(...values) >= highest, `${color}: from ${Math.min(...values)} to ${Math.max(...values)}`);
        const off = seen.map(({ x, y, value }) => {
            const at = 4 * (Math.floor(y) * png.width + Math.floor(x));
            return apart([...png.data.subarray(at, at + 3)], colorOf(value));
        });
        const usual = off.sort((a, b) => a - b)[Math.floor(0.9 * off.length)];
        assert.ok(usual < most, `${color}: points have other colours than in the legend, ${usual} degrees off`);
    }
    await assertNoErrors(page);
});

/** The edges of an object drawn in a form, or the segments of a skeleton, in pixels of the image. */
async function edgesOf(kind, name, slot) {
    const edges = await page.evaluate(
        ([wanted, called, form]) => {
            const { view } = globalThis.coppice;
            const { arrays, header } = view.objects.shown({ kind: wanted, name: called }).geometries.get(form);
            const at = (v) => view.toPixels([0, 1, 2].map((k) => arrays.position[3 * v + k] + header.origin[k]));
            if (arrays.parent) {
                return Array.from(arrays.parent, (parent, n) => (parent === 0xffffffff ? null : [at(parent), at(n)])).filter(Boolean);
            }
            const [corners, size] = arrays.quads ? [arrays.quads, 4] : [arrays.triangles, 3];
            return Array.from(corners, (v, i) => [at(v), at(corners[i % size === size - 1 ? i - size + 1 : i + 1])]);
        },
        [kind, name, slot],
    );
    return edges.map((ends) => ends.map(([x, y]) => [x, y]));
}

test("wireframe, cage, bones and points are drawn only at their positions", async () => {
    // A square of three by three faces with all edges visible.
    const corners = Array.from({ length: 16 }, (_, i) => `v ${i % 4} 0 ${Math.floor(i / 4)}`);
    const faces = Array.from({ length: 9 }, (_, i) => i + Math.floor(i / 3) + 1).map((a) => `f ${a} ${a + 1} ${a + 5} ${a + 4}`);
    await studio.write("square.obj", [...corners, ...faces, ""].join("\n"));
    await runLines(page, "loadmesh square square.obj");
    await page.evaluate(() => globalThis.coppice.view.frame());
    const plain = await drawn();
    await display({ wireframe: true });
    const wired = changes(await drawn(), plain, 6);
    assertAlong(wired, await edgesOf("mesh", "square", "surface"), { reach: 2, share: 0.9, label: "wireframe" });
    await display({ wireframe: false });

    await begin(page, ...kTree);
    const bare = await drawn();
    await display({ bones: true });
    assertAlong(changes(await drawn(), bare), await edgesOf("skeleton", "tree", "axes"), { reach: 3, share: 0.95, label: "bones" });
    await display({ bones: false, cage: true });
    await until(page, "the cage exists", () => globalThis.coppice.view.objects.shown({ kind: "skeleton", name: "tree" }).geometries.has("cage"));
    assertAlong(changes(await drawn(), bare), await edgesOf("skeleton", "tree", "cage"), { reach: 2, share: 0.4, label: "cage" });
    await display({ cage: false });

    await begin(page, kBall, "pointset generate ball count=60");
    await hide((name) => (name.startsWith("solid") ? name : null));
    await display({ pointSize: 6, points: true });
    const dotted = await drawn();
    await display({ points: false });
    const places = await page.evaluate(() => {
        const { view } = globalThis.coppice;
        const { arrays, header } = view.geometry({ kind: "points", name: "ball" });
        return Array.from({ length: arrays.position.length / 3 }, (_, n) => view.toPixels([0, 1, 2].map((k) => arrays.position[3 * n + k] + header.origin[k])));
    });
    assert.equal(places.length, 60);
    assertAlong(
        changes(dotted, await drawn()),
        places.map((at) => [at, at]),
        { reach: 4, share: 1, label: "points" },
    );
    await display({ points: true, pointSize: 3 });
    await assertNoErrors(page);
});

test("the field of a ball is drawn in the plane, with a circle at its surface", async () => {
    await runLines(page, kBall);
    await hide((name) => name);
    const empty = await drawn();
    await display({ slice: { on: true, solid: "ball", axis: "y", at: 0, lines: 8 } });
    await until(page, "the field exists", () => globalThis.coppice.view.display.sliceLegend.value !== null);
    const png = await drawn();
    const field = changes(png, empty, 6);
    assert.ok(count(field) > 1000, "some pixels are drawn");
    const [middle, right] = await toPixels([kCenter, [1, 0, 1.5]]);
    const radius = right[0] - middle[0];
    const angles = new Set();
    let astray = 0;
    field.forEach((_, i) => {
        const [r, g, b] = png.data.subarray(4 * i, 4 * i + 3);
        if (Math.abs(r - 255) < 12 && Math.abs(g - 164) < 20 && Math.abs(b - 54) < 30) {
            // the mark of the surface
            const [x, y] = [(i % png.width) + 0.5 - middle[0], Math.floor(i / png.width) + 0.5 - middle[1]];
            angles.add(Math.round((Math.atan2(y, x) * 18) / Math.PI));
            astray += Math.abs(Math.hypot(x, y) - radius) > 3 ? 1 : 0;
        }
    });
    assert.ok(angles.size >= 36, `the circle is closed: ${angles.size} of its 36 parts are visible`);
    assert.equal(astray, 0, "and no part of it is elsewhere");
    await display({ slice: { on: true, solid: "ball", axis: "x", at: 0.2, lines: 8 } });
    await settled(page);
    await until(page, "the other plane is drawn", () => globalThis.coppice.view.slice.drawn.endsWith("x 0.2"));
    const edge = boxOf(changes(await drawn(), empty, 6));
    assert.ok(edge[2] - edge[0] <= 4 && Math.abs((edge[0] + edge[2]) / 2 - middle[0]) <= 2, `a plane seen edge-on is a line, not ${edge}`);
    await display({ slice: { on: false, solid: "", axis: "y", at: 0, lines: 8 } });
    await assertNoErrors(page);
});

test("a section hides one side of its plane only", async () => {
    await runLines(page, kBall);
    const whole = await drawn();
    const empty = await drawnEmpty();
    await display({ section: { on: true, axis: "x", at: 0.2, flipped: false } });
    const cut = await drawn();
    const [[x]] = await toPixels([kCenter]);
    const sides = (mask, keep) => mask.reduce((sum, value, i) => sum + (value && keep((i % mask.width) + 0.5) ? 1 : 0), 0);
    assert.ok(sides(changes(whole, empty), (at) => at > x + 12) > 1000, "some pixels were drawn");
    assert.equal(
        sides(changes(cut, empty), (at) => at > x + 12),
        0,
        "right of the plane all pixels are removed",
    );
    assert.equal(
        sides(changes(cut, whole), (at) => at < x - 12),
        0,
        "left of it all pixels are unchanged",
    );
    await display({ section: { on: true, axis: "x", at: 0.2, flipped: true } });
    const flipped = await drawn();
    assert.equal(
        sides(changes(flipped, empty), (at) => at < x - 12),
        0,
        "and flipped it is reversed",
    );
    assert.equal(
        sides(changes(flipped, whole), (at) => at > x + 12),
        0,
    );
    // Seen along its normal the cut is a disc with an outline in the selection colour.
    await display({ section: { on: true, axis: "y", at: 0, flipped: true } });
    const open = changes(await drawn(), empty, 10);
    const box = boxOf(changes(whole, empty, 10));
    assert.ok(count(open) > 0.95 * count(changes(whole, empty, 10)), "the cut is filled");
    assert.ok(anyNear(open, (box[0] + box[2]) / 2, (box[1] + box[3]) / 2, 1));
    await display({ section: { on: false, axis: "y", at: 0, flipped: false } });
    await assertNoErrors(page);
});

test("the path tracer and the view draw a mesh at the same pixels", async () => {
    await runLines(page, ...kTree, "mesh tree levels=1");
    await hide((name) => (name.startsWith("mesh") ? null : name));
    const { width, height } = await drawn();
    for (const parallel of [true, false]) {
        await display({ parallel });
        await page.evaluate(() => {
            const { view } = globalThis.coppice;
            view.rig.orbit(0.5, 0.3, view.rig.target()); // an oblique view, to avoid accidental matches
            view.requestDraw();
        });
        const file = `seen${parallel}.png`;
        await chooseItem(page, "File", "Picture…");
        const form = dialog(page, "Image by the path tracer");
        await form.getByLabel("File in the folder").fill(file);
        for (const [label, value] of [
            ["Width", width],
            ["Height", height],
            ["Rays for each pixel", 4],
        ]) {
            await form.getByLabel(label).fill(String(value));
        }
        await form.getByLabel("Ground with shadow").setChecked(false);
        await form.getByLabel("Transparent background").setChecked(true);
        await form.getByRole("button", { name: "Draw", exact: true }).click();
        await dialog(page, file).getByRole("button", { name: "Close" }).click();
        const traced = PNG.sync.read(await studio.read(file));
        assert.deepEqual([traced.width, traced.height], [width, height]);
        const seen = changes(await drawn(), await withoutMesh(), 10);
        const truth = Object.assign(
            Uint8Array.from({ length: seen.length }, (_, i) => (traced.data[4 * i + 3] > 127 ? 1 : 0)),
            { width, height },
        );
        assert.ok(count(truth) > 3000, "the path tracer drew some pixels");
        const differ = seen.reduce((sum, value, i) => sum + (value !== truth[i] ? 1 : 0), 0);
        const rim = truth.reduce((sum, value, i) => sum + (value && (!truth[i - 1] || !truth[i + 1] || !truth[i - width] || !truth[i + width]) ? 1 : 0), 0);
        assert.ok(differ <= 0.5 * rim, `${differ} pixels differ, of ${count(truth)} with ${rim} along their outline`);
    }
    await assertNoErrors(page);
});

async function withoutMesh() {
    await hide((name) => name);
    const empty = await drawn();
    await hide((name) => (name.startsWith("mesh") ? null : name));
    await settled(page);
    return empty;
}

test("dark and light themes draw the same objects with a different background", async () => {
    await runLines(page, ...kTree);
    const masks = [];
    const skies = [];
    for (const colorScheme of ["dark", "light"]) {
        await page.emulateMedia({ colorScheme });
        const empty = await drawnEmpty();
        const full = await drawn();
        masks.push(changes(full, empty, 10));
        skies.push(empty.data.reduce((sum, value) => sum + value, 0) / empty.data.length);
    }
    await page.emulateMedia({ colorScheme: "dark" });
    assert.ok(skies[1] > skies[0] + 60, `the sky is brighter by day: ${skies}`);
    const both = masks[0].reduce((sum, value, i) => sum + (value && masks[1][i] ? 1 : 0), 0);
    assert.ok(both > 3000, "the tree is drawn");
    assert.ok(both > 0.97 * Math.max(count(masks[0]), count(masks[1])), `${masks.map(count)} pixels, of which ${both} are common`);
    await assertNoErrors(page);
});

test("a lost WebGL context is reported, and the picture is drawn again after its restoration", async () => {
    await runLines(page, ...kTree);
    const before = await drawn();
    const lost = page.getByRole("alert").filter({ hasText: "has lost the GPU" });
    await page.evaluate(() => {
        globalThis.losing = globalThis.coppice.view.element().getContext("webgl2").getExtension("WEBGL_lose_context");
        globalThis.losing.loseContext();
    });
    await lost.waitFor();
    await runLines(page, "sphere ball radius=0.15 center=0.6,0,0.6"); // objects added in between are drawn as well
    await page.evaluate(() => globalThis.losing.restoreContext());
    await lost.waitFor({ state: "hidden" });
    await hide((key) => (key === "solid:ball" ? key : null));
    assert.equal(count(changes(await drawn(), before)), 0, "the image equals the earlier one");
    await hide(() => null);
    assert.ok(count(changes(await drawn(), before)) > 300, "and the ball is drawn");
    await assertNoErrors(page);
});

test("a browser without WebGL shows an error", async () => {
    const context = await page.context().browser().newContext();
    const other = await context.newPage();
    await other.addInitScript(() => {
        HTMLCanvasElement.prototype.getContext = () => null;
    });
    await other.goto(studio.address);
    assert.match(await other.getByRole("alert").textContent(), /cannot start here.*WebGL 2/);
    await context.close();
});

test("a mesh too slow for a preview is drawn after its skeleton was hidden", async () => {
    await runLines(page, ...kTree, "mesh tree levels=6");
    const isMeshSeen = () => page.evaluate(() => globalThis.coppice.view.objects.shown({ kind: "mesh", name: "tree" }).surface.group.visible);
    await until(
        page,
        "a mesh of many triangles is drawn",
        () => globalThis.coppice.view.objects.shown({ kind: "mesh", name: "tree" })?.surface?.triangleCount > 150_000,
    );
    assert.ok(await isMeshSeen());
    await page.evaluate(() => {
        const { view, store } = globalThis.coppice;
        view.setPlainer(true); // like after a slow frame during a rotation
        store.selection.value = { ...store.selection.peek(), object: { kind: "skeleton", name: "tree" } };
    });
    assert.ok(!(await isMeshSeen()), "capsules replace it");
    await page.keyboard.press("h");
    assert.ok(await page.evaluate(() => globalThis.coppice.store.hidden.value.has("skeleton:tree")), "H hides the skeleton");
    assert.ok(await isMeshSeen(), "the mesh is drawn, since its skeleton is hidden");
    await page.evaluate(() => globalThis.coppice.view.setPlainer(false));
    assert.ok(await isMeshSeen());
    await assertNoErrors(page);
});
