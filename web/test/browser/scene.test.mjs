// The text of the scene, its objects, history and parameters, from the view of a user.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { lines, openPage, placeOf, settled, withStudio } from "./browser.mjs";
import { editorText, emptyScene, typeAtEnd, until, untilLines, untilSelected } from "./user.mjs";

let studio;
let page;

withStudio(async (begun) => {
    studio = begun;
    page = await openPage(studio);
});

beforeEach(() => emptyScene(page));

const undoNames = () => page.evaluate(() => globalThis.coppice.store.state.peek().undo);

async function write(...all) {
    await typeAtEnd(page, all.join("\n"));
    await page.keyboard.press("Control+Enter");
    await untilLines(page, all);
    await settled(page);
}

test("typed lines run after a pause; their objects are listed and drawn", async () => {
    await typeAtEnd(page, "sphere crown\nscale crown 2 2 3\n");
    await untilLines(page, ["sphere crown", "scale crown 2 2 3"]);
    await settled(page);
    await page.getByRole("treeitem", { name: /^crown/ }).waitFor();
    assert.ok(await page.evaluate(() => globalThis.coppice.view.geometry({ kind: "solid", name: "crown" })?.arrays.position.length > 0), "the crown is drawn");
    assert.deepEqual(page.complaints, []);
});

// The editor accepts a completion only some time after it appeared during typing.
async function acceptCompletion() {
    await page.evaluate(() => new Promise((done) => setTimeout(done, 100)));
    await page.keyboard.press("Enter");
}

test("completion offers commands and options, and Enter accepts one", async () => {
    await typeAtEnd(page, "sph");
    const offers = page.getByRole("listbox", { name: /completion/i });
    await offers.waitFor();
    assert.match(await offers.getByRole("option").first().textContent(), /^sphere/);
    await acceptCompletion();
    await until(page, "the command is completed", () => document.querySelector(".cm-line")?.textContent.startsWith("sphere"));
    await page.keyboard.type(" crown rad");
    await offers.getByRole("option", { name: /^radius/ }).waitFor();
    await acceptCompletion();
    await page.keyboard.type("2");
    await page.keyboard.press("Control+Enter");
    await untilLines(page, ["sphere crown radius=2"]);
});

test("an error is shown at its line and removed after the correction", async () => {
    await typeAtEnd(page, "sphere crown\nscale crwn 2\nsphere other");
    await page.keyboard.press("Control+Enter");
    await until(page, "line 2 fails", () => globalThis.coppice.store.state.peek().error?.line === 2);
    const wrong = page.locator(".cm-line", { has: page.locator(".cm-message-error") });
    assert.match(await wrong.textContent(), /^scale crwn 2.*crwn/);
    assert.match(await page.locator(".status-text").textContent(), /^Line 2: .*crwn/);
    assert.equal(await page.locator(".cm-ran-failed").count(), 1);
    await wrong.click();
    await page.keyboard.press("End");
    await page.keyboard.press("Shift+Home");
    await page.keyboard.type("scale crown 2");
    await page.keyboard.press("Control+Shift+Enter");
    await untilLines(page, ["sphere crown", "scale crown 2", "sphere other"]);
    await until(page, "the error is removed", () => globalThis.coppice.store.state.peek().error === null && !document.querySelector(".cm-message-error"));
});

test("the error of a block is shown at its line in the block", async () => {
    await typeAtEnd(page, "for i in 1..3\nsphere ball${i} center=${i},0,0\nscale bal${i} 2\nend\n");
    await until(page, "line 3 fails", () => globalThis.coppice.store.state.peek().error?.line === 3);
    await until(page, "it is reported there", () => /^ *scale bal.*bal1/.test(document.querySelector(".cm-line:has(.cm-message-error)")?.textContent ?? ""));
});

test("the scene goes back to the line of the cursor, and forward again", async () => {
    await write("sphere crown", "scale crown 2", "translate crown 0 0 4");
    await page.locator(".cm-line").nth(0).click();
    await page.getByRole("button", { name: "Run to cursor" }).click();
    await until(page, "one line has run", () => globalThis.coppice.store.state.peek().ran === 1);
    assert.equal(await page.locator(".cm-waits").count(), 2);
    await page.getByRole("button", { name: "Run all" }).click();
    await until(page, "all lines have run", () => globalThis.coppice.store.state.peek().ran === 3);
    await page.locator(".cm-ran-gutter .cm-gutterElement:visible").nth(1).click();
    await until(page, "two lines have run", () => globalThis.coppice.store.state.peek().ran === 2);
});

test("a click in the view selects an object and shows its line; a line selects its object", async () => {
    await write("sphere crown", "sphere other center=5,0,0", "translate crown 0 0 1");
    const place = await placeOf(page, [0, 0, 1]);
    await page.mouse.click(place.x, place.y);
    await untilSelected(page, "solid", "crown");
    await until(page, "its line is shown", () => document.querySelector(".cm-creator")?.textContent === "translate crown 0 0 1");
    assert.equal(await page.locator(".cm-step").first().textContent(), "sphere crown");
    await page.locator(".cm-line").nth(1).click();
    await untilSelected(page, "solid", "other");
});

test("a parameter follows its slider, and one undo reverts the drag", async () => {
    await write("sphere crown", "translate crown 0 0 2");
    await page.getByRole("treeitem", { name: /^crown/ }).click();
    await page.getByLabel("Step").selectOption({ label: "1. sphere crown" });
    const slider = page.getByRole("slider", { name: "Radius, slider" });
    await slider.scrollIntoViewIfNeeded();
    const box = await slider.boundingBox();
    const undone = await undoNames();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    for (const part of [0.55, 0.6, 0.7, 0.8]) {
        await page.mouse.move(box.x + box.width * part, box.y + box.height / 2);
        await settled(page);
    }
    await page.mouse.up();
    await until(page, "the line has a radius", () => /^sphere crown radius=[\d.]+$/.test(globalThis.coppice.store.state.peek().statements[0].text));
    const radius = Number((await lines(page))[0].split("=")[1]);
    assert.ok(radius > 1, `a drag to the right makes the ball larger than 1, not ${radius}`);
    await settled(page);
    assert.equal((await undoNames()).length, undone.length + 1, "the drag is one change");
    await page.getByRole("button", { name: "Undo", exact: true }).click();
    await untilLines(page, ["sphere crown", "translate crown 0 0 2"]);
});

test("expressions for coordinates are evaluated separately; invalid ones keep the old values", async () => {
    await write("sphere crown center=1,2,3");
    await page.getByRole("treeitem", { name: /^crown/ }).click();
    const center = page.getByRole("group", { name: "Center [m]" });
    const type = async (label, text) => {
        await center.getByLabel(label).fill("");
        await center.getByLabel(label).pressSequentially(text);
        await center.getByLabel(label).press("Enter");
    };
    await type("Y", "2*3");
    await untilLines(page, ["sphere crown center=1,6,3"]);
    for (const [text, why] of [
        ["1,5", /has a comma.*stays 6\.$/],
        ["1e999", /is too large.*stays 6\.$/],
        ["abc", /is not a number.*stays 6\.$/],
    ]) {
        await type("Y", text);
        assert.match(await center.getByRole("alert").textContent(), why);
        assert.equal(await center.getByLabel("Y").inputValue(), "6");
        await settled(page);
        assert.deepEqual(await lines(page), ["sphere crown center=1,6,3"], text);
    }
    await center.getByLabel("Z").press("ArrowUp");
    await untilLines(page, ["sphere crown center=1,6,4"]);
});

test("a new name is applied to the whole scene", async () => {
    await write("sphere crown", "scale crown 2", "pointset generate crown count=100", "delete crown kind=solid", "# crown is gone");
    await page.getByRole("treeitem", { name: /^crown/ }).click();
    await page.keyboard.press("F2");
    const name = page.getByRole("dialog", { name: "Rename points crown" }).getByLabel("Name");
    await name.fill("2x");
    assert.ok(await page.getByRole("button", { name: "Rename" }).isDisabled(), "an invalid name is refused");
    await name.fill("leaves");
    await page.keyboard.press("Enter");
    await untilLines(page, ["sphere leaves", "scale leaves 2", "pointset generate leaves count=100", "delete leaves kind=solid", "# crown is gone"]);
    await untilSelected(page, "points", "leaves");
    await page.keyboard.press("Control+z");
    await until(page, "undo restores the name", () => globalThis.coppice.store.state.peek().statements[0].text === "sphere crown");
});

test("undo, redo and the history restore earlier versions of the scene", async () => {
    for (const line of ["sphere a", "sphere b center=3,0,0", "sphere c center=6,0,0"]) {
        await page.evaluate((text) => globalThis.coppice.engine.run(text), line);
    }
    const history = page.getByRole("list", { name: "Changes of the scene" });
    await history.getByRole("button", { name: "sphere a" }).click();
    await untilLines(page, ["sphere a"]);
    assert.equal(await history.getByRole("button", { name: "sphere a" }).getAttribute("aria-current"), "step");
    await history.getByRole("button", { name: "sphere c" }).click();
    await untilLines(page, ["sphere a", "sphere b center=3,0,0", "sphere c center=6,0,0"]);
    await page.locator(".picture-canvas canvas").focus();
    await page.keyboard.press("Control+z");
    await page.keyboard.press("Control+z");
    await untilLines(page, ["sphere a"]);
    await page.keyboard.press("Control+Shift+z");
    await untilLines(page, ["sphere a", "sphere b center=3,0,0"]);
    await page.evaluate(() => globalThis.coppice.engine.run("sphere d"));
    await until(page, "a new change ends redo", () => document.querySelector("[aria-label=Redo]").disabled);
});

test("two tabs that edit different lines both get all changes", async () => {
    await write("sphere crown", "scale crown 2");
    const other = await openPage(studio);
    await typeAtEnd(page, " ".repeat(1)); // a user is typing in this tab, too
    await page.keyboard.press("Backspace");
    await other.locator(".cm-line").nth(0).click();
    await other.keyboard.press("End");
    await other.keyboard.type(" radius=1.5");
    await page.keyboard.type(" 2 3");
    await other.keyboard.press("Control+Shift+Enter");
    await page.keyboard.press("Control+Shift+Enter");
    await untilLines(other, ["sphere crown radius=1.5", "scale crown 2 2 3"]);
    await untilLines(page, ["sphere crown radius=1.5", "scale crown 2 2 3"]);
    await other.context().close();
});

test("two tabs that edit the same line must choose one version", async () => {
    await write("sphere crown", "scale crown 2");
    const other = await openPage(studio);
    await page.locator(".cm-line").nth(0).click();
    await page.keyboard.press("End");
    await page.keyboard.type(" center="); // an incomplete line, which is not applied yet
    await other.locator(".cm-line").nth(0).click();
    await other.keyboard.press("End");
    await other.keyboard.type(" radius=3");
    await other.keyboard.press("Control+Shift+Enter");
    await untilLines(other, ["sphere crown radius=3", "scale crown 2"]);
    const conflict = page.getByRole("alert").filter({ hasText: "changed elsewhere" });
    await conflict.waitFor();
    assert.equal(await conflict.locator("pre").textContent(), "sphere crown radius=3");
    assert.match(await editorText(page), /^sphere crown center=\n/, "typed text is kept");
    await page.locator(".cm-line").nth(0).click();
    await page.keyboard.press("End");
    await page.keyboard.type("0,0,7");
    await page.getByRole("button", { name: "Keep my text" }).click();
    await untilLines(other, ["sphere crown center=0,0,7", "scale crown 2"]);
    await conflict.waitFor({ state: "detached" });
    await other.context().close();
});
