// Interactive editing of branches: picked, bent, moved, rotated, scaled, drawn, thickened, pruned, cut, detached, joined,
// mirrored.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { drag, lines, openPanel, placeOf, runLines, settled, withStudio } from "./browser.mjs";
import {
    assertNoErrors,
    assertDiffer,
    begin,
    button,
    clickAt,
    differing,
    dragIn,
    field,
    kTree,
    lastLine,
    moveTo,
    near,
    numbers,
    openFront,
    picture,
    messagesOf,
    select,
    selection,
    take,
    untilFollows,
} from "./actions.mjs";
import { until } from "./user.mjs";

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openFront(studio);
});

const kOnRight = [0.9, 0, 1.72]; // on the segment that leads to node 20
async function nodesOf(name) {
    await settled(page);
    return page.evaluate((tree) => {
        const { arrays, header } = globalThis.coppice.view.geometry({ kind: "skeleton", name: tree }, "skeleton");
        return Array.from(arrays.id, (id, n) => ({ id, radius: arrays.radius[n], at: [0, 1, 2].map((k) => arrays.position[3 * n + k] + header.origin[k]) }));
    }, name);
}
const node = async (id) => (await nodesOf("tree")).find((one) => one.id === id);
const selected = () => page.evaluate(() => globalThis.coppice.activeTool.run.value.status());

test("branches are highlighted under the pointer and selected as a whole, in part or with descendants", async () => {
    await begin(page, ...kTree);
    const plain = await picture(page);
    await moveTo(page, kOnRight);
    await until(page, "the pointer finds node 20", () => globalThis.coppice.store.hover.value?.node === 20);
    assertDiffer(await picture(page), plain, "the branch glows");
    await clickAt(page, kOnRight);
    assert.deepEqual(await selection(page), { object: { kind: "skeleton", name: "tree" }, nodes: [20], extent: "branch" });
    const counts = [
        ["1", 1],
        ["2", 3],
        ["3", 2],
        ["4", 25],
        ["5", 3],
    ]; // node, branch, subtree, tree, from fork to fork
    for (const [key, count] of counts) {
        await page.keyboard.press(key);
        assert.match(await selected(), new RegExp(`: ${count} nodes? selected`), `key ${key}`);
    }
    await page.keyboard.press("2");
    await page.keyboard.down("Shift");
    await clickAt(page, [-0.9, 0, 2.54]); // node 23
    await page.keyboard.up("Shift");
    assert.deepEqual((await selection(page)).nodes, [20, 23], "Shift adds");
    await page.keyboard.press("Escape");
    assert.equal((await selection(page)).object, null);

    await page.keyboard.press("b");
    await dragIn(page, [
        [0.4, 0, 1.2],
        [1.7, 0, 2.2],
    ]);
    await until(page, "the box holds the branch", () => globalThis.coppice.store.selection.value.nodes.length === 3);
    assert.deepEqual((await selection(page)).nodes.sort(), [19, 20, 21]);
    await assertNoErrors(page);
});

test("branches are selected, bent and pruned on the surface of a tree; undo restores them", async () => {
    await begin(page, ...kTree);
    const eye = () => page.evaluate(() => globalThis.coppice.view.rig.pose.eye.toArray());
    const hidden = () => page.evaluate(() => [...globalThis.coppice.store.hidden.value]);
    const before = await eye();
    const plain = await picture(page);
    await select(page, "skeleton", "tree");
    await openPanel(page, "Growth");
    await page.getByRole("button", { name: "Make the surface" }).click();
    assert.match(await lastLine(page, /^mesh /), /^mesh tree/);
    const surface = (drawn) =>
        until(
            page,
            drawn ? "the mesh is drawn" : "the tree is drawn",
            (wanted) => {
                const { view } = globalThis.coppice;
                const isSeen = (kind) => view.objects.shown({ kind, name: "tree" })?.surface?.group.visible === true;
                return isSeen("mesh") === wanted && isSeen("skeleton") !== wanted;
            },
            drawn,
        );
    await surface(true);

    await take(page, "View", "Select");
    await clickAt(page, kOnRight);
    assert.deepEqual(await selection(page), { object: { kind: "skeleton", name: "tree" }, nodes: [20], extent: "branch" });
    await take(page, "Branches", "Bend");
    const made = await picture(page);
    await dragIn(page, [kOnRight, [0.9, 0, 1.32]], { during: () => untilFollows(page, "skeleton", "tree") });
    await until(page, "a line bends the tree before its mesh is made", () => {
        const { statements, running } = globalThis.coppice.store.state.peek();
        return running === null && statements.length === 5 && statements[3].text.startsWith("edit bend tree");
    });
    await surface(true);
    assertDiffer(await picture(page), made, "the mesh has bent");
    await take(page, "Branches", "Prune");
    await dragIn(page, [
        [-1.2, 0, 2.7],
        [-1.5, 0, 2.85],
    ]);
    await until(page, "a tip was cut", () => globalThis.coppice.store.state.peek().statements.some(({ text }) => text.startsWith("edit delete tree")));
    await surface(true);

    for (let steps = 3; steps > 0; --steps) {
        await page.keyboard.press("Control+z");
        await until(page, `${steps} steps remain`, (left) => globalThis.coppice.store.state.peek().statements.length === left, 2 + steps);
    }
    await surface(false);
    assert.deepEqual(await lines(page), kTree);
    assert.deepEqual(await hidden(), []);
    assert.deepEqual(await eye(), before, "the camera does not move");
    await take(page, "View", "Select");
    await select(page, "skeleton", "none");
    assert.ok(differing(await picture(page), plain) < 50, "the image equals the earlier one");

    await runLines(page, "mesh tree skin");
    await page.evaluate(() => (globalThis.coppice.store.hidden.value = new Set(["skeleton:tree"])));
    await settled(page);
    await take(page, "Branches", "Bend");
    await dragIn(page, [kOnRight, [0.9, 0, 1.32]]);
    assert.match((await messagesOf(page)).at(-1), /^The skeleton tree is hidden; show it/);
    assert.equal((await lines(page)).length, 4);
    await assertNoErrors(page);
});

test("a branch and its surface bend to the pointer, and undo reverts it", async () => {
    await begin(page, ...kTree);
    const straight = await picture(page);
    await take(page, "Branches", "Bend");
    await dragIn(page, [kOnRight, [0.9, 0, 1.32]], { during: () => untilFollows(page, "skeleton", "tree", "the surface of the tree follows the pointer") });
    const line = await lastLine(page, /^edit bend tree at\(/);
    near(numbers(line, "towards"), [0, 0, -1], 0.05, line);
    near((await node(20)).at, [1, 0, 1.4], 0.2, "the dragged point is at the position of the release");
    assert.deepEqual((await selection(page)).nodes, [20], "the dragged branch is selected");
    assertDiffer(await picture(page), straight, "the branch has moved");
    await page.keyboard.press("Control+z");
    await until(page, "undo", () => globalThis.coppice.store.state.peek().statements.length === 3);
    await settled(page);
    near((await node(20)).at, [1, 0, 1.8], 1e-4, "undo restores it");
    await page.keyboard.press("Control+y");
    assert.equal(await lastLine(page, /^edit bend/), line, "redo runs the same line");

    await field(page, "Angle [°]").fill("20");
    await page.locator(".tool-panel").getByRole("button", { name: "Z", exact: true }).click();
    await button(page, "Apply").click();
    assert.match(await lastLine(page, / 20 towards=/), /^edit bend tree at\(\S+\) 20 towards=0,0,1$/);
    await assertNoErrors(page);
});

test("a node moves with the part of its axis that is set by the wheel", async () => {
    await begin(page, ...kTree);
    await take(page, "Branches", "Reshape");
    await dragIn(page, [kOnRight, [0.9, 0, 2.12]], { during: () => untilFollows(page, "skeleton", "tree") });
    near(numbers(await lastLine(page, /^edit move tree /), "by"), [0, 0, 0.4], 0.02, "the node followed the pointer");
    await page.mouse.wheel(0, -100);
    const [from, to] = [(await node(19)).at, (await node(20)).at];
    const on = to.map((value, k) => from[k] + 0.8 * (value - from[k]));
    await dragIn(page, [on, [on[0], 0, on[2] - 0.2]]);
    assert.ok(numbers(await lastLine(page, /^edit move tree .*reach=/), "reach")[0] > 0);
    await field(page, "Reach, 0 = whole axis [m]").fill("0");
    await assertNoErrors(page);
});

test("branches are moved, rotated and scaled by handles and typed numbers", async () => {
    await begin(page, ...kTree);
    await select(page, "skeleton", "tree", [19], "subtree");
    await settled(page);
    await take(page, "View", "Move");
    await page.keyboard.type("0.1,0,0.25");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^edit translate/), /^edit translate tree at\(\S+\) 0\.1 0 0\.25$/);
    await take(page, "View", "Turn");
    await page.keyboard.press("y");
    await page.keyboard.type("30");
    await untilFollows(page, "skeleton", "tree");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^edit rotate/), /^edit rotate tree at\(\S+\) 30 axis=0,1,0$/);
    await take(page, "View", "Size");
    await page.keyboard.type(".5");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^edit scale/), /^edit scale tree at\(\S+\) 0\.5$/);
    await page.keyboard.press("Escape");

    await select(page, "skeleton", "tree", [22], "subtree");
    await page.keyboard.press("g"); // follows the pointer at once
    const from = await placeOf(page, [-1, 0, 1]);
    const to = await placeOf(page, [-1, 0, 1.3]);
    await page.mouse.move(from.x, from.y);
    await page.mouse.move(to.x, to.y, { steps: 4 });
    await page.mouse.down();
    await page.mouse.up();
    near((await lastLine(page, /^edit translate .* 0 0\.3/)).split(" ").slice(-3).map(Number), [0, 0, 0.3], 0.02, "as far as the pointer went");
    await assertNoErrors(page);
});

test("the wheel and a sideways drag change the thickness of branches", async () => {
    await begin(page, ...kTree);
    const before = (await node(20)).radius;
    await take(page, "Branches", "Radius");
    const { x, y } = await placeOf(page, kOnRight);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -300);
    await untilFollows(page, "skeleton", "tree");
    const factor = numbers(await lastLine(page, /^edit thicken tree axis\(/), 4)[0];
    assert.ok(factor > 1.05, `a turn up is thicker: ${factor}`);
    near([(await node(20)).radius], [before * factor], before * 0.01, "thickness equals the reported one");
    await dragIn(page, [kOnRight, [0.6, 0, 1.72]]);
    assert.ok(numbers(await lastLine(page, /^edit thicken tree axis\(\S+\) 0\./), 4)[0] < 1, "to the left is thinner");
    await assertNoErrors(page);
});

test("a stroke on an axis draws a branch; elsewhere it draws a stem", async () => {
    await begin(page, ...kTree);
    const before = await picture(page);
    await take(page, "Branches", "Draw");
    await dragIn(
        page,
        [
            [0, 0, 2.5],
            [0.3, 0, 2.8],
            [0.7, 0, 2.9],
        ],
        { during: () => untilFollows(page, "skeleton", "tree") },
    );
    const line = await lastLine(page, /^edit draw tree (?!0,0,2 )/); // and not the last of the initial lines
    near(numbers(line, 3), [0, 0, 2.5], 0.05, "it begins on the stem");
    const points = line
        .split(" ")
        .slice(3)
        .map((word) => word.split(",").map(Number));
    near(points.at(-1), [0.7, 0, 2.9], 0.1, "and ends where the pen was lifted, at the depth of the branches around");
    assertDiffer(await picture(page), before, "one more branch is drawn");
    await dragIn(page, [
        [1.4, 0, 0.1],
        [1.4, 0, 0.5],
        [1.5, 0, 1],
    ]);
    assert.match(await lastLine(page, /^limb /), /^limb tree2 /);
    await assertNoErrors(page);
});

test("strokes that end before their start is found all become branches", async () => {
    await begin(page, ...kTree);
    await take(page, "Branches", "Draw");
    await page.evaluate(() => (globalThis.coppice.store.hidden.value = new Set(["skeleton:tree"]))); // so that its axes have to be requested
    let release;
    const released = new Promise((resolve) => (release = resolve));
    await page.route("**/blob/**", async (route) => {
        await released;
        await route.continue();
    });
    try {
        await page.evaluate(() => globalThis.coppice.engine.run("edit move tree 24 by=0,0,0.1"));
        await dragIn(page, [
            [0, 0, 2.5],
            [0.3, 0, 2.8],
            [0.7, 0, 2.9],
        ]);
        await dragIn(page, [
            [0, 0, 1.5],
            [-0.3, 0, 1.8],
            [-0.7, 0, 1.9],
        ]);
        await page.evaluate(() => globalThis.coppice.engine.run("edit move tree 24 by=0,0,0.1")); // the requested data is out of date now
        assert.equal((await lines(page)).length, 5, "both wait");
    } finally {
        release();
    }
    await until(page, "both are branches of the tree", () => {
        const { statements, running } = globalThis.coppice.store.state.peek();
        return running === null && statements.slice(5).filter(({ text }) => text.startsWith("edit draw tree ")).length === 2;
    });
    await page.unroute("**/blob/**");
    await assertNoErrors(page);
});

test("the prune brush removes the tips along its path", async () => {
    await begin(page, ...kTree);
    const whole = await picture(page);
    await take(page, "Branches", "Prune");
    await dragIn(
        page,
        [
            [1.5, 0, 2.3],
            [1.5, 0, 1.8],
        ],
        { during: () => untilFollows(page, "skeleton", "tree"), steps: 1 },
    );
    await lastLine(page, /^edit delete tree at\(/);
    assert.equal(await node(21), undefined, "the tip is removed");
    assert.equal((await nodesOf("tree")).length, 24, "and no other node");
    assertDiffer(await picture(page), whole, "the branch is shorter", 10);
    await assertNoErrors(page);
});

test("branches are cut, detached, moved away and joined again", async () => {
    await begin(page, ...kTree);
    await take(page, "Branches", "Cut");
    const whole = await picture(page);
    await moveTo(page, [-0.4, 0, 2.24]);
    await until(page, "the cut is announced", () => globalThis.coppice.activeTool.run.value.status().includes("will be cut off"));
    await clickAt(page, [-0.4, 0, 2.24]);
    await lastLine(page, /^edit delete tree /);
    assert.equal(await node(24), undefined);
    assertDiffer(await picture(page), whole, "the branch is removed");

    await take(page, "Branches", "Detach");
    await clickAt(page, [0.4, 0, 1.32]);
    await lastLine(page, /^edit detach tree /);
    await select(page, "skeleton", "tree", [20], "tree");
    await settled(page);
    await take(page, "View", "Move");
    await page.keyboard.type("0.3,0,0");
    await page.keyboard.press("Enter");
    await lastLine(page, /^edit translate tree /);
    near((await node(18)).at, [0, 0, 3], 1e-4, "the stem remains");
    near((await node(21)).at, [1.8, 0, 2], 1e-3, "the branch has moved");

    await take(page, "Branches", "Graft");
    await dragIn(page, [
        [0.8, 0, 1.4],
        [0, 0, 2.5],
    ]);
    assert.match(await lastLine(page, /^edit graft tree /), /^edit graft tree at\(/);
    await assertNoErrors(page);
});

test("branches are mirrored, straightened and smoothed; undo and redo cover all steps", async () => {
    await begin(page, ...kTree);
    await select(page, "skeleton", "tree", [19], "subtree");
    await settled(page);
    await take(page, "Branches", "Mirror");
    await page.keyboard.press("x");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^edit mirror/), / normal=1,0,0$/);
    near((await node(21)).at, [-1.5, 0, 2], 1e-3, "the other way round");
    for (const [label, pattern] of [
        ["Straighten", /^edit straighten tree \S+ amount=1$/],
        ["Smooth", /^edit smooth tree axis\(\S+\) passes=4$/],
        ["Taper", /^edit taper tree /],
    ]) {
        await take(page, "Branches", label);
        await page.keyboard.press("Enter");
        await lastLine(page, pattern);
    }
    const all = await lines(page);
    assert.equal(all.length, 7);
    const final = await picture(page);
    for (let i = 0; i < 4; ++i) {
        await page.keyboard.press("Control+z");
    }
    await until(page, "four steps back", () => globalThis.coppice.store.state.peek().statements.length === 3);
    for (let i = 0; i < 4; ++i) {
        await page.keyboard.press("Control+y");
    }
    await until(page, "and forth", () => globalThis.coppice.store.state.peek().statements.length === 7);
    assert.deepEqual(await lines(page), all);
    await settled(page);
    const again = await picture(page);
    assert.ok(Buffer.compare(final.data, again.data) === 0, "the image is bit-identical");
    await assertNoErrors(page);
});

test("an imported tree is edited like a grown one", async () => {
    await studio.write("oak.swc", await readFile(new URL("../../../examples/oak.swc", import.meta.url)));
    await begin(page, "loadtree tree oak.swc");
    await page.evaluate(() => globalThis.coppice.view.frame());
    await settled(page);
    const before = await picture(page);
    await take(page, "Branches", "Bend");
    // A branch that is not occluded: the picked branch at the position of one of its nodes in the view.
    const found = await page.evaluate(() => {
        const { view } = globalThis.coppice;
        const { arrays, header } = view.geometry({ kind: "skeleton", name: "tree" }, "skeleton");
        for (let n = 40; n < arrays.id.length; ++n) {
            const at = [0, 1, 2].map((k) => arrays.position[3 * n + k] + header.origin[k]);
            const [x, y] = view.toPixels(at);
            if (x > 400 && arrays.order[n] === 1 && view.pick(x, y)?.node === arrays.id[n]) {
                return at;
            }
        }
        return null;
    });
    assert.ok(found, "some branch is visible");
    const { x, y } = await placeOf(page, found);
    await drag(
        page,
        [
            { x, y },
            { x: x + 20, y: y + 40 },
        ],
        5,
    );
    await lastLine(page, /^edit bend tree at\(/);
    assertDiffer(await picture(page), before, "the oak is bent", 20);
    await assertNoErrors(page);
});
