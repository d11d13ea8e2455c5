// Interactive points and growth: from a crown to a tree that is visible while it grows; and trees composed from branches of
// others.
import assert from "node:assert/strict";
import { test } from "node:test";
import { lines, openPanel, placeOf, runLines, settled, withStudio } from "./browser.mjs";
import {
    assertNoErrors,
    assertDiffer,
    begin,
    button,
    dragIn,
    field,
    kTree,
    lastLine,
    moveTo,
    near,
    numbers,
    openFront,
    picture,
    pictureNow,
    select,
    take,
    untilFollows,
} from "./actions.mjs";
import { until, untilLines, untilObject } from "./user.mjs";

let studio, page;

withStudio(async (begun) => {
    studio = begun;
    page = await openFront(studio);
});

const kCrown = "sphere crown radius=1 center=0,0,2";
const step = (name) => page.locator(`.step:has(#step-${name})`);
const untilCounted = (count) =>
    until(
        page,
        `${count} points are counted and shown`,
        ([text, number]) => {
            const shown = globalThis.coppice.view.geometry({ kind: "points", name: "crown" })?.arrays.position.length / 3;
            return document.querySelector("#step-points .count")?.textContent === text && shown === number;
        },
        [`${count.toLocaleString("en")} points`, count],
    );
/** The balls in the view: [x, y, z, radius]. */
const balls = () =>
    page.evaluate(() => {
        const all = globalThis.coppice.view.overlay.children.flatMap((group) => group.children).filter(({ geometry }) => geometry.type === "SphereGeometry");
        return all.map(({ position, geometry }) => [...position.toArray(), geometry.parameters.radius]);
    });
/** The first line of the statement of a command, after it has run. */
async function lineOf(command, pattern = /^/) {
    await until(
        page,
        `${command} exists as ${pattern}, and no command runs`,
        ([word, source]) => {
            const { statements, running, ran } = globalThis.coppice.store.state.peek();
            const all = statements.map(({ text }) => text.split("\n")[0]);
            return running === null && ran === statements.length && all.some((line) => line.startsWith(`${word} `) && new RegExp(source).test(line));
        },
        [command, pattern.source],
    );
    await settled(page);
    return (await lines(page)).find((line) => line.startsWith(`${command} `)).split("\n")[0];
}
const hide = (...keys) => page.evaluate((all) => (globalThis.coppice.store.hidden.value = new Set(all)), keys); // objects that are slow to draw

async function unfold(name) {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))); // a selection may have unfolded another
    const title = step(name).locator(".step-title");
    if ((await title.getAttribute("aria-expanded")) === "false") {
        await title.click();
    }
}

/** Drags a slider through fractions of its length; the button remains pressed. */
async function slide(slider, parts) {
    await slider.scrollIntoViewIfNeeded();
    const box = await slider.boundingBox();
    const y = box.y + box.height / 2;
    const now = await slider.evaluate((input) => (input.value - input.min) / (input.max - input.min));
    await page.mouse.move(box.x + 8 + (box.width - 16) * now, y);
    await page.mouse.down();
    for (const part of parts) {
        await page.mouse.move(box.x + 8 + (box.width - 16) * part, y, { steps: 2 });
    }
}

test("a crown is filled with points, and the preview follows the settings", async () => {
    await begin(page, kCrown);
    await select(page, "solid", "crown");
    const points = step("points");
    await points.getByLabel("Count", { exact: true }).fill("500");
    await untilCounted(500);
    assert.deepEqual(await lines(page), [kCrown], "it is only a preview");
    await points.getByRole("button", { name: "Fill crown with points" }).click();
    await untilLines(page, [kCrown, "pointset generate crown count=500"]);

    await select(page, "points", "crown");
    await hide("solid:crown");
    await unfold("points");
    const before = await picture(page);
    await slide(points.getByRole("slider", { name: "Count, slider" }), [0.55, 0.6, 0.65]);
    await until(page, "more points are visible, and their count", () => {
        const shown = globalThis.coppice.view.geometry({ kind: "points", name: "crown" })?.arrays.position.length / 3;
        return shown > 700 && document.querySelector("#step-points .count").textContent === `${shown.toLocaleString("en")} points`;
    });
    assertDiffer(await picture(page), before, "there are more points in the view");
    assert.deepEqual(await lines(page), [kCrown, "pointset generate crown count=500"]);
    await page.mouse.up();
    const line = await lastLine(page, /^pointset generate crown count=(?!500$)\d+$/);
    await untilCounted(numbers(line, "count")[0]);
    await page.getByRole("button", { name: "Undo", exact: true }).click();
    await untilCounted(500);
    await assertNoErrors(page);
});

test("points are created by patterns and seeds, on a mesh, by thinning and by adding", async () => {
    await begin(page, kCrown, "pointset generate crown count=400");
    await hide("solid:crown");
    await select(page, "points", "crown");
    await unfold("points");
    const points = step("points");
    const placesOf = () => page.evaluate(() => globalThis.coppice.view.geometry({ kind: "points", name: "crown" }).arrays.position.slice(0, 30).join());
    const first = await placesOf();
    await points.getByLabel("Pattern").selectOption("clustered");
    await untilLines(page, [kCrown, "pointset generate crown clustered count=400"]);
    await settled(page);
    const clustered = await placesOf();
    assert.notEqual(clustered, first);
    await points.getByRole("button", { name: "Next seed" }).click();
    await untilLines(page, [kCrown, "pointset generate crown clustered count=400 seed=1"]);
    await settled(page);
    assert.notEqual(await placesOf(), clustered, "another seed creates others");

    await points.getByRole("button", { name: "Thin" }).click();
    await points.getByLabel("Percent", { exact: true }).fill("25");
    await untilCounted(300);
    await points.getByRole("button", { name: "Thin the points" }).click();
    await lastLine(page, /^pointset thin crown crown 25$/);
    await points.getByRole("button", { name: "Add", exact: true }).click();
    await points.getByLabel("Count", { exact: true }).fill("150");
    await points.getByRole("button", { name: "Add points" }).click();
    await lastLine(page, /^pointset densify crown crown .*150/);
    await untilCounted(450);

    await runLines(page, "limb tree 0,0,0 0,0,1 radius=0.2", "mesh tree levels=0");
    await points.getByRole("button", { name: "Over a mesh" }).click();
    await points.getByLabel("Count", { exact: true }).fill("200");
    await points.getByRole("button", { name: "Cover tree with points" }).click();
    await untilObject(page, "points", "shell");
    assert.equal(await page.evaluate(() => globalThis.coppice.store.find("points", "shell").count), 200);
    await assertNoErrors(page);
});

test("a ball removes or adds points; a click places a tree", async () => {
    await begin(page, kCrown, "pointset generate crown count=800");
    await hide("solid:crown");
    await select(page, "points", "crown");
    await settled(page);
    await take(page, "Points", "Brush");
    const at = await page.evaluate(() => {
        const { arrays, header } = globalThis.coppice.view.geometry({ kind: "points", name: "crown" });
        const all = Array.from({ length: arrays.position.length / 3 }, (_, n) => [0, 1, 2].map((k) => arrays.position[3 * n + k] + header.origin[k]));
        return all.filter(([x, , z]) => Math.hypot(x, z - 2) < 0.3).sort((a, b) => a[1] - b[1])[0]; // the closest to the camera
    });
    await dragIn(page, [at, [at[0] + 0.4, at[1], at[2]]], {
        during: async () =>
            assert.ok(await page.evaluate(() => globalThis.coppice.view.overlay.children.some(({ children }) => children.length > 0)), "the ball is visible"),
    });
    assert.match(await lastLine(page, /^repeat 1\n {2}sphere dab [^\n]*\n {2}pointset thin crown dab 100\n {2}delete dab kind=solid\nend$/), /radius=0\.4\d*/);
    const left = await page.evaluate(() => globalThis.coppice.store.find("points", "crown").count);
    assert.ok(left < 800, `${left} points remain`);
    await field(page, "The ball").selectOption("densify");
    await field(page, "How many").fill("70");
    await button(page, "Apply there").click();
    await until(page, "70 points are added", (count) => globalThis.coppice.store.find("points", "crown").count === count, left + 70);

    await take(page, "Points", "Root");
    const foot = await placeOf(page, [0.5, 0, 0]);
    await page.mouse.click(foot.x, foot.y);
    await page.keyboard.press("Enter");
    const line = await lastLine(page, /^grow tree crown root=/);
    near(numbers(line, "root"), [0.5, 0, 0], 0.1, line);
    await untilObject(page, "skeleton", "tree");
    await assertNoErrors(page);
});

const kPoints = [kCrown, "pointset generate crown count=600"];

test("radii are drawn as balls with the number of points inside", async () => {
    await begin(page, ...kPoints);
    await hide("solid:crown");
    await unfold("tree");
    const tree = step("tree");
    assert.deepEqual(await balls(), []);
    const plain = await picture(page);
    await tree.getByLabel("Influence radius [m]", { exact: true }).fill("0.7");
    await until(page, "balls of that radius are visible", () => {
        const { children } = globalThis.coppice.view.overlay;
        return children.flatMap((group) => group.children).some(({ geometry }) => geometry.parameters?.radius === 0.7);
    });
    const [root, ...samples] = await balls();
    assert.deepEqual(root, [0, 0, 0, 0.7], "one at the root");
    assert.equal(samples.length, 3, "and some at points");
    assertDiffer(await picture(page), plain, "the balls", 500);
    await moveTo(page, [0, 0, 2]);
    await until(page, "the pointer is on a point", () => globalThis.coppice.store.hover.value !== null);
    const at = await page.evaluate(() => globalThis.coppice.store.hover.value.point);
    await until(page, "a ball follows the pointer", () => /^At the pointer/.test(document.querySelector("#step-tree .count")?.textContent));
    near((await balls())[1], [...at, 0.7], 1e-6, "the ball at the pointer");
    const within = (radius) =>
        page.evaluate(
            ([x, y, z, most]) => {
                const { arrays, header } = globalThis.coppice.view.geometry({ kind: "points", name: "crown" });
                const [a, b, c] = header.origin;
                return Array.from({ length: arrays.position.length / 3 }, (_, n) => arrays.position.slice(3 * n, 3 * n + 3)).filter(
                    (p) => Math.hypot(p[0] + a - x, p[1] + b - y, p[2] + c - z) < most,
                ).length;
            },
            [...at, radius],
        );
    const kill = Number(await tree.getByLabel("Kill radius [m]", { exact: true }).inputValue());
    assert.equal(await tree.locator(".count").textContent(), `At the pointer ${await within(0.7)} of 600 points attract, ${await within(kill)} are removed.`);
    await tree.getByLabel("Kill radius [m]", { exact: true }).focus();
    await until(
        page,
        "the balls are those of the kill radius",
        (radius) => globalThis.coppice.view.overlay.children.flatMap((group) => group.children).some(({ geometry }) => geometry.parameters?.radius === radius),
        kill,
    );
    await tree.getByLabel("Tropism weight", { exact: true }).focus();
    await until(
        page,
        "the balls are removed",
        () => !globalThis.coppice.view.overlay.children.some((group) => group.children.some(({ geometry }) => geometry.type === "SphereGeometry")),
    );
    await assertNoErrors(page);
});

test("parameters describe their valid values and reject others", async () => {
    await begin(page, ...kPoints);
    await unfold("tree");
    const tree = step("tree");
    const kill = tree.getByLabel("Kill radius [m]", { exact: true });
    const help = await kill.evaluate((input) => document.getElementById(input.getAttribute("aria-describedby")).textContent);
    assert.match(help, /^Distance within which attractors are spent\. Accepts a number \[m\] from 0\.000001 to 1000000\.$/);
    const before = await tree.locator("code.line").textContent();
    await kill.fill("-1");
    assert.equal(await kill.getAttribute("aria-invalid"), "true");
    assert.equal(await tree.locator("code.line").textContent(), before, "it is refused");
    await kill.fill("0.3");
    await kill.press("Enter");
    assert.equal(await kill.getAttribute("aria-invalid"), null);
    assert.match(await tree.locator("code.line").textContent(), /kill_radius=0\.3/);
    const refused = tree.locator(".field-error");
    for (const [typed, why] of [
        ["1,5", "has a comma"],
        ["1e999", "is too large"],
        ["abc", "is not a number"],
        ["-2*3", "Enter a number from"],
    ]) {
        await kill.fill("");
        await kill.pressSequentially(typed);
        await kill.press("Enter");
        assert.match(await refused.textContent(), new RegExp(`${why}.* The field stays 0\\.3\\.$`), typed);
        assert.equal(await kill.inputValue(), "0.3", typed);
        assert.match(await tree.locator("code.line").textContent(), /kill_radius=0\.3\b/, typed);
    }
    await kill.fill("");
    await kill.pressSequentially("0.1*3+0.1");
    await kill.press("Enter");
    assert.equal(await kill.inputValue(), "0.4", "arithmetic is computed");
    assert.equal(await refused.count(), 0);
    await kill.press("ArrowDown");
    assert.equal(await kill.inputValue(), "0.3", "a step down");
    await tree.getByText("All options").click();
    await tree.getByLabel("Max turn [°]").fill("40");
    assert.match(await tree.locator("code.line").textContent(), /max_turn=40/);
    await tree.getByRole("button", { name: "Grow a tree" }).click();
    const line = (await lineOf("grow")).split(" ");
    assert.ok(line.includes("kill_radius=0.3") && line.includes("max_turn=40"), line.join(" "));
    await assertNoErrors(page);
});

test("a tree grows, and changes with its seed and radii", async () => {
    await begin(page, ...kPoints);
    await page.locator(".step-run", { hasText: "Grow a tree" }).click();
    const first = await lineOf("grow");
    const [grown, radii, tidy] = (await lines(page)).slice(2).join("\n").split("\n");
    assert.match(grown, /^grow tree crown root=0,0,0 .*jitter=0\.1/);
    assert.match(radii, /^radii tree tip_radius=/);
    assert.equal(tidy, "tidy tree");
    const pointsHidden = () => page.evaluate(() => globalThis.coppice.store.hidden.value.has("points:crown"));
    assert.ok(await pointsHidden(), "points are hidden");
    await unfold("tree");
    const tree = step("tree");
    await tree.getByRole("button", { name: "Next seed" }).click();
    assert.match(await lineOf("grow", / seed=1$/), /jitter=0\.1/);
    await tree.getByRole("button", { name: "Random seed" }).click();
    await lineOf("grow", / seed=(?!1$)\d+$/);
    const before = await page.evaluate(() => globalThis.coppice.store.find("skeleton", "tree").count);
    const held = await lineOf("grow");
    await slide(tree.getByRole("slider", { name: "Kill radius, slider" }), [0.6, 0.7]);
    await until(
        page,
        "the tree follows the slider",
        () => globalThis.coppice.view.geometry({ kind: "skeleton", name: "tree" }, "skeleton").header.seq !== undefined,
    );
    assert.equal(await lineOf("grow"), held, "it is only a preview");
    await page.mouse.up();
    await until(page, "the tree has other nodes", (nodes) => globalThis.coppice.store.find("skeleton", "tree").count < nodes, before);
    assert.equal((await lines(page)).filter((line) => line.startsWith("grow")).length, 1, "it is one tree");
    assert.notEqual(await lineOf("grow"), first);
    await tree.getByRole("button", { name: "By rules" }).click();
    await tree.getByLabel("Seasons", { exact: true }).fill("4");
    await tree.getByRole("button", { name: "Grow a tree" }).click();
    await untilObject(page, "skeleton", "tree2");
    assert.match(await lineOf("sprout"), /^sprout tree2 .*seasons=4/);
    assert.ok(await pointsHidden());
    while (await page.evaluate(() => globalThis.coppice.store.find("skeleton", "tree") !== undefined)) {
        await page.evaluate(() => globalThis.coppice.engine.request("undo"));
        await settled(page);
    }
    assert.ok(!(await pointsHidden()), "and are visible again after undo");
    await assertNoErrors(page);
});

test("growth is shown during the run; it can be stopped, discarded, kept and continued", async () => {
    const all = ["sphere crown radius=1 center=0,0,2", "pointset generate crown uniform count=300000", "delete crown kind=solid"];
    await begin(page);
    await hide("points:crown");
    await runLines(page, ...all);
    const empty = await picture(page);
    await unfold("tree");
    const tree = step("tree");
    await tree.getByRole("button", { name: "Into points" }).click();
    for (const [label, value] of [
        ["Influence radius [m]", "3"],
        ["Kill radius [m]", "0.01"],
        ["Step [m]", "0.005"],
    ]) {
        await tree.getByLabel(label, { exact: true }).fill(value); // it grows long enough for the test to observe it
    }
    const growing = page.getByRole("group", { name: "Growth", exact: true });
    const stopped = page.getByRole("group", { name: "Growth that was stopped" });
    const untilGrown = () =>
        until(page, "the growth is reported and visible", () => {
            const { grown } = globalThis.coppice.view;
            const nodes = /^([\d,]+) nodes so far$/.exec(document.querySelector(".growing [role=status]")?.textContent)?.[1].replace(/,/g, "");
            return Number(nodes) >= 500 && grown.group.children.length > 0;
        });
    await tree.getByRole("button", { name: "Grow a tree" }).click();
    await untilGrown();
    assertDiffer(await pictureNow(page), empty, "the growing tree is visible");
    assert.deepEqual(await lines(page), all, "it is not a tree yet");
    await growing.getByRole("button", { name: "Stop" }).click();
    await stopped.getByRole("button", { name: "Discard it" }).click();
    await stopped.waitFor({ state: "detached" });
    await until(page, "its result is not visible", () => globalThis.coppice.view.grown.group.children.length === 0);
    assert.deepEqual(await lines(page), all);

    await tree.getByRole("button", { name: "Grow a tree" }).click();
    await untilGrown();
    await growing.getByRole("button", { name: "Stop" }).click();
    await stopped.waitFor();
    const nodes = Number(/Stopped with ([\d,]+) nodes/.exec(await stopped.textContent())[1].replace(/,/g, ""));
    assertDiffer(await picture(page), empty, "it remains in the view");
    await stopped.getByRole("button", { name: "Keep it" }).click();
    await untilObject(page, "skeleton", "tree");
    const line = await lineOf("grow");
    assert.match(line, / max_iterations=\d+/);
    const rounds = numbers(line, "max_iterations")[0];
    const kept = await page.evaluate(() => globalThis.coppice.store.find("skeleton", "tree").count);
    near([kept], [nodes], nodes / 50, "the kept tree equals the intermediate result");

    await tree.getByText(`It was stopped after ${rounds} steps.`).waitFor();
    await tree.getByRole("button", { name: "Continue the growth" }).click();
    await growing.getByText("nodes so far").waitFor();
    await growing.getByRole("button", { name: "Stop" }).click();
    await stopped.getByRole("button", { name: "Discard it" }).click();
    await stopped.waitFor({ state: "detached" });
    assert.equal(await lineOf("grow"), line, "the kept tree exists again");
    await assertNoErrors(page);
});

const branches = () => page.getByRole("listbox", { name: "Branches of the library" }).getByRole("option");
const untilPictures = (within, count) =>
    until(
        page,
        `${count} branches have images`,
        ([selector, wanted]) => {
            return (
                document.querySelectorAll(`${selector} svg.silhouette`).length === wanted &&
                [...document.querySelectorAll(`${selector} svg.silhouette`)].every((svg) => svg.querySelector("path"))
            );
        },
        [within, count],
    );

/** Drags a branch of the library to a position of the scene. */
async function dragOut(number, point, during) {
    const cell = page.locator(`#branch-${number}`);
    await cell.scrollIntoViewIfNeeded();
    const box = await cell.boundingBox();
    const to = await placeOf(page, point);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 8 });
    await during?.();
    await page.mouse.up();
}

test("branches are stored in a library with pictures, and grafted by drag and drop or by keys", async () => {
    await begin(page, ...kTree);
    await openPanel(page, "Library");
    await page.getByLabel("Name of the new library").fill("oaks");
    await page.getByRole("button", { name: "Use it" }).click();
    await page.getByLabel("Tag", { exact: true }).fill("oak");
    await page.getByRole("button", { name: "All of the tree" }).click();
    await lastLine(page, /^library add oaks\.branches tree tag=oak$/);
    await branches().first().waitFor();
    assert.equal(await branches().count(), 4); // the two on the stem, and the segments of the stem above each
    await branches().last().scrollIntoViewIfNeeded(); // only visible images are made
    await untilPictures(".branches", 4);
    assert.match(await branches().first().textContent(), /oak/);

    const all = await lines(page);
    const nodes = Number(/(\d+) nodes/.exec(await page.locator("#branch-1").getAttribute("title"))[1]);
    const onStem = [0, 0, 2.6];
    await dragOut(1, onStem, () => untilFollows(page, "skeleton", "tree", "the branch is shown on the tree"));
    await lastLine(page, /^library graft tree oaks\.branches 1 /); // after the statement that filled the library
    await until(page, "the branch has been grafted", (count) => globalThis.coppice.store.find("skeleton", "tree").count === count, 25 + nodes);
    await until(page, "the tool is inactive", () => globalThis.coppice.store.tool.value === "select");
    await page.keyboard.press("Control+z");
    await untilLines(page, all);
    await dragOut(1, [2.5, 0, 0.5]); // away from the tree
    await settled(page);
    assert.deepEqual(await lines(page), all);

    await select(page, "skeleton", "tree", [12]);
    await branches().first().focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Enter");
    await until(page, "it is shown on the node", () => globalThis.coppice.activeTool.run.value.status().includes("on node 12 of tree"));
    await page.keyboard.press("ArrowUp");
    await page.keyboard.press("Enter");
    assert.match(await lastLine(page, /^library graft tree oaks\.branches /), /scale=1\.1$/);
    await page.keyboard.press("Escape");
    await page.getByLabel("Find by number, tag or source").fill("birch");
    await page.getByText("0 of 4 branches").waitFor();
    await page.getByRole("button", { name: "Show all" }).click();
    assert.equal(await branches().count(), 4);
    await assertNoErrors(page);
});

test("trees are composed of branches: seeds are chosen by pictures, then the replaced branches and the variation", async () => {
    await begin(page, ...kTree, "edit draw tree 0,0,2.5 0.4,0,2.8 0.8,0,2.9 radius=0.04");
    await select(page, "skeleton", "tree");
    await openPanel(page, "Composition");
    const seeds = page.getByRole("group", { name: "Seeds: each creates another tree" });
    const seed = (n) => seeds.getByRole("button", { name: `Seed ${n}`, exact: true });
    await seed(8).scrollIntoViewIfNeeded();
    await untilPictures(".seeds", 8);
    const shapes = () => seeds.locator("svg.silhouette").evaluateAll((all) => new Set(all.map((svg) => svg.innerHTML)).size);
    assert.ok((await shapes()) > 4, "seeds create different trees");
    assert.equal((await lines(page)).length, 4, "they are only previews");

    await seed(3).click();
    await lineOf("compose", /^compose composed tree .*seed=3$/);
    assert.equal(await seed(3).getAttribute("aria-pressed"), "true");
    assert.ok(await page.evaluate(() => globalThis.coppice.store.hidden.value.has("skeleton:tree")), "the template is hidden");
    await seed(5).click();
    await lineOf("compose", /seed=5\b/);
    assert.equal((await lines(page)).filter((line) => line.startsWith("compose")).length, 1, "one replaces the other");

    const options = page.locator("#body-compose");
    await options.getByLabel("Probability", { exact: true }).fill("0");
    await page.keyboard.press("Enter");
    await lineOf("compose", /probability=0\b/);
    await settled(page);
    const count = (name) => page.evaluate((called) => globalThis.coppice.store.find("skeleton", called).count, name);
    assert.equal(await count("composed"), await count("tree"), "nothing is replaced");
    await options.getByLabel("Probability", { exact: true }).fill("1");
    await page.keyboard.press("Enter");
    await lineOf("compose", /probability=1\b/);
    await options.getByText("Randomise").click();
    await options.getByLabel("Turn [°]", { exact: true }).fill("60");
    await page.keyboard.press("Enter");
    await lineOf("compose", /turn=60\b/);
    await page.getByRole("button", { name: "More seeds" }).click();
    await seed(9).waitFor();
    await seed(9).click();
    await lineOf("compose", /seed=9\b/);
    await assertNoErrors(page);
});

test("a surface gets a bark as one change, is drawn with its images, and loses it", async () => {
    await begin(page, "limb tree 0,0,0 0,0,1 0,0,2 0,0,3 radius=0.4", "mesh tree levels=0");
    const plain = ["limb tree 0,0,0 0,0,1 0,0,2 0,0,3 radius=0.4", "mesh tree levels=0"];
    const barked = (species) => [plain[0], `material bark ${species}`, "mesh tree levels=0 uv=bark material=bark"];
    const textures = () => page.evaluate(() => globalThis.coppice.view.memory.textures);
    await select(page, "mesh", "tree");
    await openPanel(page, "Growth");
    const bare = await picture(page);
    const before = await textures();
    const bark = page
        .locator("#step-surface label")
        .filter({ has: page.getByText("Bark", { exact: true }) })
        .locator("select");
    assert.equal(await bark.inputValue(), "");
    await bark.selectOption("oak");
    await untilLines(page, barked("oak"));
    const oak = await picture(page);
    assertDiffer(bare, oak, "the bark is drawn", 500);
    assert.equal((await textures()) - before, 4, "it has images of colour, normals, roughness and occlusion");
    assert.equal(await bark.inputValue(), "oak");
    await bark.selectOption("birch");
    await untilLines(page, barked("birch"));
    assertDiffer(oak, await picture(page), "another bark is drawn", 500);
    assert.equal((await textures()) - before, 4, "the images of oak are released");
    await page.evaluate(() => globalThis.coppice.command("undo"));
    await untilLines(page, barked("oak"));
    assert.deepEqual(await picture(page), oak);
    await page.evaluate(() => globalThis.coppice.command("undo"));
    await untilLines(page, plain);
    await bark.selectOption("oak");
    await untilLines(page, barked("oak"));
    await bark.selectOption("none");
    await untilLines(page, plain);
    assertDiffer(oak, await picture(page), "the bark is no longer drawn", 500);
    assert.equal(await textures(), before);
    await assertNoErrors(page);
});
