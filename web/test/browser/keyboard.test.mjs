// From an empty scene to an exported surface with the keyboard only: no pointer events.
import assert from "node:assert/strict";
import { test } from "node:test";
import { lines, openPage, settled, withStudio } from "./browser.mjs";
import { checkFile, until, untilObject } from "./user.mjs";

let studio;
let page;

withStudio(async (begun) => {
    studio = begun;
    page = await openPage(studio);
    await page.evaluate(() => {
        globalThis.pointed = 0;
        for (const type of ["pointerdown", "mousedown", "touchstart"]) {
            addEventListener(type, () => ++globalThis.pointed, true);
        }
    });
});

const press = async (...keys) => {
    for (const key of keys) {
        await page.keyboard.press(key);
    }
};

/** Name and role of the focused element. */
const focused = () =>
    page.evaluate(() => {
        const element = document.activeElement;
        const label = element.getAttribute("aria-label") ?? element.labels?.[0]?.querySelector("span")?.textContent ?? element.labels?.[0]?.textContent;
        const text = element.matches(".menu-item") ? element.querySelector("span").textContent : element.textContent;
        return (label ?? text).trim().slice(0, 60);
    });

/** Presses a key until the focused element has this name. */
async function goTo(name, key = "Tab", most = 150) {
    const seen = [];
    for (let n = 0; n < most; ++n) {
        seen.push(await focused());
        if (name instanceof RegExp ? name.test(seen.at(-1)) : seen.at(-1) === name) {
            return;
        }
        await press(key);
    }
    assert.fail(`${key} does not lead to ${name}, but to: ${seen.join(" | ")}`);
}

async function chooseByKeys(menu, item) {
    await until(page, "no dialog is open", () => !document.querySelector("dialog[open]"));
    await press("F10");
    await goTo(menu, "ArrowRight", 12);
    await press("ArrowDown");
    await goTo(item, "ArrowDown", 25);
    await press("Enter");
}

const untilLast = (line) =>
    until(
        page,
        `the last line is "${line}"`,
        (wanted) => {
            const { statements, ran, running, error } = globalThis.coppice.store.state.peek();
            return running === null && error === null && ran === statements.length && statements.at(-1)?.text === wanted;
        },
        line,
    );

const goToPicture = () => goTo(/^View of the scene/, "F6", 8);

test("a crown is created by the menu, moved and scaled by typed numbers", async () => {
    await chooseByKeys("Crown", "Ball of 2 m");
    await untilLast("sphere crown radius=2 center=0,0,4");
    await settled(page);
    await press("g", "z", "1", "Enter");
    await untilLast("translate crown 0 0 1");
    await press("s", "1", ".", "1", "Enter");
    await until(page, "the crown is larger", () => globalThis.coppice.store.state.peek().statements.at(-1).text.startsWith("scale crown 1.1"));
    await press("Control+z");
    await untilLast("translate crown 0 0 1");
});

test("points and a tree are created by menus and dialogs", async () => {
    await chooseByKeys("Points", "Fill with points…");
    await goTo(/Number of points/);
    await page.keyboard.type("600");
    await press("Enter");
    await untilLast("pointset generate crown count=600 seed=0");
    await chooseByKeys("Growth", "Grow into points…");
    await goTo(/Kill radius/);
    await page.keyboard.type("0.4");
    await press("Enter");
    await untilObject(page, "skeleton", "tree");
    assert.match((await lines(page)).at(-1), /^grow tree crown .*kill_radius=0.4/);
    await chooseByKeys("Growth", "Radii by the pipe model");
    await untilLast("radii tree");
});

test("the list of objects hides, renames and selects objects", async () => {
    await goToPicture();
    await press("Shift+F6");
    await goTo("Objects");
    await press("Tab", "End");
    assert.match(await focused(), /^tree/);
    await press("F2");
    await goTo("Name");
    await page.keyboard.type("oak");
    await press("Enter");
    await untilObject(page, "skeleton", "oak");
    await until(
        page,
        "the row has the focus again",
        () => document.activeElement.getAttribute("role") === "treeitem" || document.activeElement === document.body,
    );
    await goToPicture();
    await press("Shift+F6");
    await goTo("Objects");
    await press("Tab", "Home", "ArrowDown", "h");
    await until(page, "the crown is hidden", () => globalThis.coppice.store.hidden.peek().has("solid:crown"));
    await press("o", "Enter");
    await until(page, "the tree is selected", () => globalThis.coppice.store.selection.peek().object?.name === "oak");
});

test("nodes are selected by keys, and a branch is thickened by a typed factor", async () => {
    await settled(page);
    await goToPicture();
    await press("]", "]", "]");
    await until(page, "a node is selected", () => globalThis.coppice.store.selection.peek().nodes.length === 1);
    await press("t");
    await page.keyboard.type("1.2");
    await press("Enter");
    await until(page, "the branch is thicker", () => /^edit thicken oak .* 1\.2/.test(globalThis.coppice.store.state.peek().statements.at(-1).text));
    await press("Escape");
});

test("a line is typed into the text of the scene", async () => {
    for (let n = 0; n < 7 && !(await page.evaluate(() => document.activeElement.closest(".bottom") !== null)); ++n) {
        await press("F6");
    }
    await goTo("Text of the scene");
    await press("Control+End");
    await page.keyboard.type("tidy oak");
    await press("Control+Enter");
    await untilLast("tidy oak");
    await press("Escape");
});

test("a form creates the surface", async () => {
    await press("F6");
    await goTo("Command");
    await press("Enter");
    await goTo("Search commands");
    await page.keyboard.type("mesh");
    await press("Enter");
    await goTo("Levels");
    await press("Control+a");
    await page.keyboard.type("1");
    await press("Enter");
    await untilLast("mesh oak levels=1");
    await settled(page);
});

test("the exported surface is sound", async () => {
    await press("Control+e");
    await goTo("Format");
    await goTo("File in the folder");
    await page.keyboard.type("oak");
    await press("Enter");
    await until(page, "it is written and checked", () => document.querySelector("dialog[open] .verdict.good"));
    assert.equal(await focused(), "Close");
    await press("Enter");
    await until(page, "the dialog is closed", () => !document.querySelector("dialog[open]"));
    await checkFile(studio, "oak.glb");
    await press("Control+s");
    await goTo("Name in the folder");
    await page.keyboard.type("oak");
    await press("Enter");
    await until(page, "the scene is saved", () => globalThis.coppice.store.state.peek().saved);
    assert.equal(String(await studio.read("oak.coppice")).trim(), (await lines(page)).join("\n"));
    assert.equal(await page.evaluate(() => globalThis.pointed), 0, "no pointer was used");
    assert.deepEqual(page.complaints, []);
});
