// Interactive crown tools: primitives, gizmo, combinations, warps, profiles, curves, and solids from them.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { lines, placeOf, settled, withStudio } from "./browser.mjs";
import {
    assertNoErrors,
    assertDiffer,
    begin,
    button,
    chooseIn,
    clickAt,
    dragIn,
    field,
    hideAll,
    lastLine,
    near,
    numbers,
    openFront,
    picture,
    select,
    selection,
    take,
    untilFollows,
} from "./actions.mjs";
import { until, untilSelected } from "./user.mjs";

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openFront(studio);
});

beforeEach(() => begin(page));

test("every primitive is placed by a drag and by its fields", async () => {
    await page.evaluate(() => {
        globalThis.coppice.view.look("top");
        globalThis.coppice.view.frameAround([-0.8, 0, 0], 2);
    });
    const empty = await picture(page);
    await take(page, "Crown", "Place");
    const kinds = ["sphere", "box", "cylinder", "cone", "line", "circle", "disc"];
    for (const [i, kind] of kinds.entries()) {
        const middle = [0.7 * (i % 4) - 0.3, 0.4 - 0.8 * Math.floor(i / 4), 0];
        await chooseIn(page, "Shape", kind);
        await dragIn(page, [middle, [middle[0] + 0.3, middle[1], 0]], { during: () => (i === 0 ? untilFollows(page, "solid", "ball") : undefined) });
        if (["box", "cylinder", "cone", "line"].includes(kind)) {
            await clickAt(page, [middle[0] + 0.3, middle[1], 0]); // as high as it is wide
        }
        const line = await lastLine(page, new RegExp(`^${kind} `));
        if (kind === "sphere") {
            near(numbers(line, "center"), middle, 0.02, line);
            near(numbers(line, "radius"), [0.3], 0.02, line);
            assertDiffer(await picture(page), empty, "the ball is drawn");
        }
        await hideAll(page);
    }
    assert.equal((await lines(page)).length, kinds.length);

    await chooseIn(page, "Shape", "sphere");
    for (const [label, value] of [
        ["X", "1.5"],
        ["Y", "0"],
        ["Z", "2.25"],
        ["Radius [m]", "0.75"],
    ]) {
        await field(page, label).fill(value);
    }
    await untilFollows(page, "solid", "ball2", "fields show a preview");
    await field(page, "Radius [m]").press("Enter");
    assert.equal(await lastLine(page, /^sphere /), "sphere ball2 center=1.5,0,2.25 radius=0.75");
    await untilSelected(page, "solid", "ball2");
    await assertNoErrors(page);
});

const names = (page) =>
    page.evaluate(() =>
        globalThis.coppice.store.state
            .peek()
            .objects.map(({ name }) => name)
            .sort(),
    );
const untilBalls = (page, count) =>
    until(
        page,
        `${count} balls exist`,
        (wanted) => {
            const { objects, statements, running } = globalThis.coppice.store.state.peek();
            return running === null && statements.length >= wanted && objects.filter(({ name }) => name.startsWith("ball")).length === wanted;
        },
        count,
    );

test("each click with Place creates one object, also with fast clicks and running commands", async () => {
    await page.evaluate(() => {
        globalThis.coppice.view.look("top");
        globalThis.coppice.view.frameAround([-0.8, 0, 0], 2);
    });
    await take(page, "Crown", "Place");
    const eye = () => page.evaluate(() => globalThis.coppice.view.rig.pose.eye.toArray());
    const before = await eye();
    const at = await placeOf(page, [0, 0.8, 0]);
    await page.mouse.dblclick(at.x, at.y);
    for (const x of [-0.2, 0.2, 0.6]) {
        const { x: left, y: top } = await placeOf(page, [x, 0, 0]);
        await page.mouse.click(left, top);
    }
    await untilBalls(page, 5);
    assert.deepEqual(await names(page), ["ball", "ball2", "ball3", "ball4", "ball5"]);
    assert.equal((await lines(page)).length, 5);
    assert.deepEqual(await eye(), before, "a double click with an active tool moves no object");
    assert.equal(await field(page, "Name").inputValue(), "ball6");

    const long = page.evaluate(() => globalThis.coppice.engine.run("pointset generate ball uniform count=400000").then(() => true));
    await until(page, "the long line runs", () => {
        const { running, ran } = globalThis.coppice.store.state.peek();
        return running !== null || ran > 5; // independent of the speed of this machine
    });
    for (const x of [-0.2, 0.2, 0.6]) {
        await clickAt(page, [x, -0.8, 0]);
    }
    assert.ok(await long);
    await untilBalls(page, 9); // the points have the name of their ball
    assert.equal((await lines(page)).length, 9);
    await assertNoErrors(page);
});

test("two pages that place objects concurrently do not overwrite each other", async () => {
    const other = await openFront(studio);
    try {
        for (const tab of [page, other]) {
            await take(tab, "Crown", "Place");
        }
        await Promise.all([page, other].map((tab, i) => clickAt(tab, [i, 0, 1])));
        await untilBalls(page, 2);
        await untilBalls(other, 2);
        assert.deepEqual(await names(page), ["ball", "ball2"]);
    } finally {
        await other.context().close();
    }
    await assertNoErrors(page);
});

test("handles move, rotate and scale solids, with typed numbers, snapping by Ctrl and cancelling by Escape", async () => {
    await begin(page, "sphere a center=0,0,1.5 radius=0.5");
    await select(page, "solid", "a");
    const start = await picture(page);
    await take(page, "View", "Move");
    const reach = await page.evaluate(() => 70 * globalThis.coppice.view.pixelSize([0, 0, 1.5])); // on the shaft of an arrow
    const onArrow = [0, 0, 1.5 + reach];
    await dragIn(page, [onArrow, [0.4, 0, 1.5 + reach + 0.6]], { during: () => untilFollows(page, "solid", "a") });
    near((await lastLine(page, /^translate a /)).split(" ").slice(2).map(Number), [0, 0, 0.6], 0.03, "only along the arrow");
    assertDiffer(await picture(page), start, "the ball has moved");

    await dragIn(
        page,
        [
            [0, 0, 2.1],
            [0.43, 0, 2.1],
        ],
        { keys: ["Control"] },
    );
    const [x] = (await lastLine(page, /^translate a (?!0 0 )/)).split(" ").slice(2).map(Number);
    const step = await page.evaluate(() => globalThis.coppice.view.pixelSize([0, 0, 2]) * 20);
    assert.ok(Math.abs(x / 0.1 - Math.round(x / 0.1)) < 1e-6 && Math.abs(x - 0.43) <= step, `${x} is a step of the grid`);

    await take(page, "View", "Turn");
    await page.keyboard.press("z");
    await page.keyboard.type("30");
    await untilFollows(page, "solid", "a");
    await page.keyboard.press("Escape");
    await page.keyboard.press("z");
    await page.keyboard.type("45");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^rotate a /), /^rotate a 45 center=/);

    await take(page, "View", "Size");
    await field(page, "Z").fill("1.5");
    await button(page, "Apply").click();
    assert.match(await lastLine(page, /^scale a /), /^scale a 1,1,1\.5 center=/);
    await assertNoErrors(page);
});

test("a stroke across two solids selects them, and a list sets their operation", async () => {
    await begin(page, "sphere a center=-0.4,0,1.5 radius=0.8", "sphere b center=0.6,0,1.5 radius=0.7");
    const apart = await picture(page);
    await take(page, "Crown", "Combine");
    for (const [label, command] of [
        ["Union", "union"],
        ["Difference", "diff"],
        ["Blend with exponent", "ricci"],
    ]) {
        await dragIn(page, [
            [-0.8, 0, 1.5],
            [1, 0, 1.5],
        ]);
        const list = page.locator(".tool-list");
        await list.waitFor();
        if (command === "ricci") {
            await list.getByLabel("Exponent").fill("3");
        }
        const choice = list.getByRole("button", { name: label, exact: true });
        if (command === "diff") {
            await choice.hover();
            await untilFollows(page, "solid", "crown", `${label} is shown before it is chosen`);
        }
        await choice.click();
        assert.equal(await lastLine(page, /crown/), `${command} a b crown${command === "ricci" ? " exponent=3" : ""}`);
        const hidden = await page.evaluate(() => [...globalThis.coppice.store.hidden.value]);
        assert.deepEqual(hidden.sort(), ["solid:a", "solid:b"], "operands are in the result");
        if (command === "diff") {
            assertDiffer(await picture(page), apart, "b is subtracted from a");
        }
        await page.keyboard.press("Control+z");
        await until(page, "the operation is undone", () => globalThis.coppice.store.state.peek().statements.length === 2);
        await page.evaluate(() => globalThis.coppice.command("show-all"));
        await until(page, "both operands are drawn again", () => ["a", "b"].every((name) => globalThis.coppice.view.geometry({ kind: "solid", name })));
    }
    await page.keyboard.press("Escape");
    await assertNoErrors(page);
});

test("handles at the end of a solid bend, twist and taper it", async () => {
    for (const [label, command, way] of [
        ["Bend", "bend", 0.5],
        ["Twist", "twist", 0.5],
        ["Taper", "taper", -0.5],
    ]) {
        await begin(page, "line tower from=0,0,0.3 to=0,0,2.7 radius=0.3");
        await select(page, "solid", "tower");
        const upright = await picture(page);
        await take(page, "Crown", label);
        await dragIn(
            page,
            [
                [0, 0, 3],
                [way, 0, 3],
            ],
            { during: () => untilFollows(page, "solid", "tower") },
        );
        const line = await lastLine(page, new RegExp(`^${command} tower `));
        if (command === "bend") {
            // The chord from the base to the end rotates by atan(0.5 / 3) = 9.46 degrees, the end by twice that angle.
            near(numbers(line, 2), [18.9], 0.6, line);
            near(numbers(line, "side"), [1, 0, 0], 0.01, line);
        } else if (command === "taper") {
            assert.ok(numbers(line, 2)[0] < 1, `to the left is narrower: ${line}`);
        } else {
            assert.ok(numbers(line, 2)[0] > 5, `to the right is counter-clockwise: ${line}`);
        }
        assertDiffer(await picture(page), upright, `${command} changes the image`);
    }
    await assertNoErrors(page);
});

test("a profile is drawn in its plane and revolved; dragged points update the solid", async () => {
    await take(page, "Crown", "Profile");
    const plane = page.locator(".plane");
    const box = await plane.boundingBox();
    const [middle, height] = [box.x + box.width / 2, box.y + box.height / 2];
    for (const [x, y] of [
        [0, 100],
        [60, 60],
        [90, -10],
        [50, -80],
        [0, -120],
    ]) {
        await page.mouse.click(middle + x, height + y);
    }
    assert.equal(await plane.locator("circle").count(), 5);
    await untilFollows(page, "profile", "outline", "the outline is shown");
    await button(page, "Make it").click();
    assert.equal((await lastLine(page, /^profile outline /)).split(" ").length, 2 + 5);
    await button(page, "Make a solid of it").click();
    await untilFollows(page, "solid", "solid", "the revolution is shown");
    await page.keyboard.press("Enter");
    assert.equal(await lastLine(page, /^revolve /), "revolve solid outline");

    await select(page, "profile", "outline");
    await take(page, "Crown", "Profile");
    await until(page, "the points of the profile exist", () => document.querySelectorAll(".plane circle").length === 5);
    const wide = numbers((await lines(page))[0], 4)[0];
    const handle = await plane.locator("circle").nth(2).boundingBox();
    await page.mouse.move(handle.x + 7, handle.y + 7);
    await page.mouse.down();
    await page.mouse.move(handle.x + 47, handle.y + 7, { steps: 4 });
    await untilFollows(page, "solid", "solid", "the solid follows its profile");
    await page.mouse.up();
    await until(
        page,
        "the point is written",
        (before) => Number(globalThis.coppice.store.state.peek().statements[0].text.split(" ")[4].split(",")[0]) > before + 0.05,
        wide,
    );
    assert.equal((await lines(page))[1], "revolve solid outline");

    await plane.locator("circle").nth(1).focus();
    const written = (await lines(page))[0];
    for (let i = 0; i < 5; ++i) {
        await page.keyboard.press("ArrowRight");
    }
    await until(page, "arrow keys move a point", (text) => globalThis.coppice.store.state.peek().statements[0].text !== text, written);
    await settled(page);
    await page.keyboard.press("Control+z");
    await until(page, "one undo reverts the five steps", (text) => globalThis.coppice.store.state.peek().statements[0].text === text, written);
    await button(page, "Done").click();
    await assertNoErrors(page);
});

test("a curve is drawn, typed and edited; a sweep and a skin follow it", async () => {
    await begin(page, "profile round circle=0.2", "profile slim circle=0.1");
    await take(page, "Crown", "Curve");
    await clickAt(page, [0, 0, 0.5]);
    await clickAt(page, [0.3, 0, 1.2]);
    await clickAt(page, [0, 0, 2]);
    await page.keyboard.type("0.5,0,2.5");
    await page.keyboard.press("Enter");
    await untilFollows(page, "path", "path", "the curve is shown");
    await page.keyboard.press("Enter");
    const drawn = await lastLine(page, /^path path /);
    assert.equal(drawn.split(" ").length, 2 + 4);
    near(numbers(drawn, 3), [0.3, 0, 1.2], 0.02, "at the clicked position");
    assert.deepEqual(numbers(drawn, 5), [0.5, 0, 2.5], "at the typed position");

    await dragIn(
        page,
        [
            [0.3, 0, 1.2],
            [0.6, 0, 1.2],
        ],
        { during: () => untilFollows(page, "path", "path") },
    );
    await until(
        page,
        "the point is where it was dragged",
        () => Math.abs(Number(globalThis.coppice.store.state.peek().statements[2].text.split(" ")[3].split(",")[0]) - 0.6) < 0.02,
    );

    await take(page, "Crown", "Revolve, sweep, skin");
    await chooseIn(page, "Is", "sweep");
    await chooseIn(page, "Profile", "round");
    await field(page, "Size at the end").fill("0.5");
    await untilFollows(page, "solid", "solid", "the sweep is shown");
    await button(page, "Make it").click();
    assert.equal(await lastLine(page, /^sweep /), "sweep solid round path scale=0,1 scale=1,0.5");

    await take(page, "Crown", "Revolve, sweep, skin");
    await chooseIn(page, "Is", "skin");
    await chooseIn(page, "Section 1", "round");
    await chooseIn(page, "Section 2", "slim");
    await field(page, "Name").fill("skin");
    await button(page, "Make it").click();
    assert.equal(await lastLine(page, /^skin /), "skin skin path round@0 slim@1");
    await assertNoErrors(page);
});

test("a click selects the object at its position, and a click elsewhere deselects", async () => {
    await begin(page, "sphere far center=1.2,0,2.4 radius=0.3");
    const { x, y } = await placeOf(page, [1.2, 0, 2.4]);
    await page.mouse.click(x, y);
    assert.deepEqual((await selection(page)).object, { kind: "solid", name: "far" });
    await page.mouse.click(x, y + 150);
    assert.equal((await selection(page)).object, null, "a click away from all objects selects nothing");
});
