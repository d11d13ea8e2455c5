// Accessibility of the page: axe-core on all of its content, dark and light; focus; reduced motion; magnified pages.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { before, describe, test } from "node:test";
import { openPage, openPanel, runLines, settled, withStudio } from "./browser.mjs";
import { dialog, drop, emptyScene, typeAtEnd, until, untilLines, untilObject } from "./user.mjs";

const kScene = [
    "limb tree 0,0,0 0,0,1 0,0,2 radius=0.1 tip_radius=0.05",
    "edit draw tree 0,0,1 0.5,0,1.4 1,0,1.8 radius=0.06",
    "mesh tree levels=0",
    "sphere crown",
    "sphere other center=3,0,0",
    "pointset generate crown count=50",
    "library add oaks.branches tree",
];

let studio;
let page;
let axe;
let scheme = "dark";

withStudio(async (begun) => {
    axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
    studio = begun;
    page = await openPage(studio, { colorScheme: "dark", deviceScaleFactor: 0.5, reducedMotion: "reduce" });
    await page.evaluate(axe);
    await page.evaluate(() => (globalThis.coppice.view.display.shadow.value = false));
});

/** Fails with the findings of axe in regions of the page: with all rules, and in the light scheme again for contrast. */
async function checkPart(label, parts = ["body"], on = page) {
    const runOnly = scheme === "light" ? ["color-contrast"] : undefined;
    const found = await on.evaluate(
        async ([selectors, rules]) => {
            const options = { preload: false, resultTypes: ["violations"], rules: { "target-size": { enabled: true } }, ...(rules && { runOnly: rules }) };
            const { violations } = await globalThis.axe.run({ include: selectors }, options);
            return violations.map(
                ({ id, nodes }) =>
                    `${id}: ${nodes
                        .slice(0, 3)
                        .map(({ target, any, all }) => `${target} ${[...any, ...all][0]?.message ?? ""}`)
                        .join("; ")}`,
            );
        },
        [parts, runOnly],
    );
    assert.deepEqual(found, [], label);
}

async function select(kind, name, nodes = []) {
    await page.evaluate(
        ([of, called, ids]) => {
            globalThis.coppice.store.selection.value = { object: called === "" ? null : { kind: of, name: called }, nodes: ids, extent: "branch" };
        },
        [kind, name, nodes],
    );
    await settled(page);
}

for (const colorScheme of ["dark", "light"]) {
    describe(colorScheme, () => {
        before(async () => {
            scheme = colorScheme;
            await page.emulateMedia({ colorScheme });
            await emptyScene(page);
        });

        test("the initial page and an error in its scene are accessible", async () => {
            await checkPart("the empty page");
            await typeAtEnd(page, "sphere crown\nscale crwn 2\nsphere other\n");
            await until(page, "the error is reported", () => document.querySelector(".cm-message-error"));
            await page.evaluate(() => globalThis.coppice.store.notify("This is wrong.", "error"));
            await page.evaluate(() => globalThis.coppice.store.notify("This may be wrong.", "warning"));
            await checkPart("an error in the scene, and messages");
            await emptyScene(page);
        });

        test("every menu and the menu of an object are accessible", async () => {
            await runLines(page, ...kScene);
            const titles = await page.locator(".menu-title").allTextContents();
            assert.ok(titles.length >= 9, `the menus are ${titles}`);
            await page.keyboard.press("F10");
            await page.keyboard.press("ArrowDown");
            for (const title of colorScheme === "dark" ? titles : titles.slice(0, 1)) {
                await page.getByRole("menu", { name: title }).waitFor();
                await checkPart(`the menu ${title}`, [".menu-bar"]);
                await page.keyboard.press("ArrowRight");
            }
            await page.keyboard.press("Escape");
            await page.keyboard.press("Escape");
            await page.getByRole("button", { name: "More about other" }).click();
            await page.getByRole("menu", { name: "solid other" }).waitFor();
            await checkPart("the menu of an object", [".context-menu"]);
            await page.keyboard.press("Escape");
        });

        const whole = colorScheme === "dark" ? test : test.skip; // named colours cover both schemes: the following tests have no colours of their own
        whole("every tool", async () => {
            const node = await page.evaluate(() => globalThis.coppice.view.geometry({ kind: "skeleton", name: "tree" }, "skeleton").arrays.id[4]);
            const selections = [
                ["skeleton", "tree", [node]],
                ["solid", "crown", []],
                ["points", "crown", []],
                ["mesh", "tree", []],
                ["solid", "", []],
            ];
            const left = new Set(await page.evaluate(() => globalThis.coppice.tools.map(({ id }) => id)));
            for (const [kind, name, nodes] of selections) {
                await select(kind, name, nodes);
                const able = await page.evaluate(() =>
                    globalThis.coppice.tools.filter(({ enabled }) => !enabled || enabled(globalThis.coppice)).map(({ id }) => id),
                );
                for (const id of able.filter((one) => left.delete(one))) {
                    await select(kind, name, nodes);
                    await page.evaluate((wanted) => globalThis.coppice.take(wanted), id);
                    await checkPart(`the tool ${id}`, [".picture-canvas", ".tool-panel"]);
                    await page.evaluate(() => globalThis.coppice.take("select"));
                }
            }
            assert.deepEqual([...left], ["loft"], "tools that require another selection"); // it requires profiles
        });

        whole("every dialog", async () => {
            const command = (id) => page.evaluate((one) => globalThis.coppice.command(one), id);
            const checkDialog = async (title) => {
                await dialog(page, title).waitFor();
                await checkPart(`the dialog ${title}`, ["dialog[open]"]);
            };
            const leave = async () => {
                await page.keyboard.press("Escape");
                await until(page, "the dialog is closed", () => !document.querySelector("dialog[open]"));
            };
            await studio.write("a.coppice", "sphere a\n");
            await select("skeleton", "tree");
            for (const [id, title] of [
                ["save-as", "Save the scene"],
                ["open", "Open a scene"],
                ["shortcuts", "Keyboard shortcuts"],
                ["menu-file", "The menu is a text file"],
                ["rename", "Rename skeleton tree"],
                ["picture", "Image by the path tracer"],
            ]) {
                await command(id);
                await checkDialog(title);
                await leave();
            }
            await command("export");
            await checkDialog("Export");
            await page.keyboard.press("Enter");
            await dialog(page, "Exported").getByText("Figures of the check").click();
            await checkDialog("Exported");
            await page.getByRole("button", { name: "Export more" }).click();
            await page.getByRole("button", { name: "Export", exact: true }).click();
            await checkDialog("Replace the file?");
            await page.keyboard.press("Escape");
            await dialog(page, "Replace the file?").waitFor({ state: "hidden" });
            await leave();
            await command("picture");
            await dialog(page, "Image by the path tracer").getByLabel("Width").fill("32");
            await dialog(page, "Image by the path tracer").getByLabel("Height").fill("32");
            await page.keyboard.press("Enter");
            await checkDialog("picture.png");
            await leave();
            await drop(page, { name: "cloud.xyz", bytes: Buffer.from("0 0 0\n1 0 0\n0 1 0\n") });
            await checkDialog("How should cloud.xyz be imported?");
            await leave();
            await page.getByRole("tab", { name: "Animation" }).click();
            await page.getByRole("button", { name: "Export…" }).click();
            await checkDialog("Export the film");
            await leave();
            await page.getByRole("tab", { name: "Scene" }).click();
            await page.keyboard.press("F10");
            await page.keyboard.press("g");
            await page.keyboard.press("ArrowDown");
            await page.keyboard.press("t");
            await page.getByRole("menuitem", { name: "Tree by rules…" }).click();
            await checkDialog("Tree by rules");
            await leave();
        });

        test("every panel is accessible for any selection", async () => {
            for (const title of ["Command", "Library", "Composition", "Check", "Display"]) {
                await openPanel(page, title);
            }
            await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = true)));
            for (const [kind, name] of [
                ["skeleton", "tree"],
                ["mesh", "tree"],
                ["solid", "crown"],
                ["points", "crown"],
            ]) {
                await select(kind, name);
                await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = true)));
                await checkPart(`panels with the ${kind} ${name} selected`, [".side.left", ".side.right"]);
            }
            await page.getByRole("tab", { name: "Animation" }).click();
            await page.getByRole("button", { name: "Add a key here" }).click();
            await checkPart("the timeline", [".bottom"]);
            await page.getByRole("tab", { name: "Scene" }).click();
            await select("mesh", "tree");
            await page.getByRole("button", { name: "Check mesh tree" }).click();
            await page.locator(".check .verdict").waitFor();
            await checkPart("the check of a mesh", [".check"]);
        });

        test("forms of commands are accessible", async () => {
            const search = page.getByRole("combobox", { name: "Search commands" });
            for (const command of colorScheme === "dark" ? ["grow", "union", "edit bend", "polygonize", "extract"] : ["edit bend"]) {
                await search.fill(command);
                await page.keyboard.press("Enter");
                const form = page.getByRole("form", { name: command, exact: true });
                await form.waitFor();
                await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = true)));
                await checkPart(`the form of ${command}`, [".command-form[aria-label]"]);
                await form.getByRole("button", { name: "Other command" }).click();
            }
        });
    });
}

/** The focused element, and its location in the page. */
const focused = () =>
    page.evaluate(() => {
        const element = document.activeElement;
        const part = [".header", ".side.left", ".picture-frame", ".tool-bar", ".bottom", ".side.right"].find((one) => element.closest(one)) ?? "";
        return { part, tag: element.outerHTML.slice(0, 120), isBody: element === document.body };
    });

/** Whether the focus is visible. */
const isFocusSeen = () => {
    const element = document.activeElement;
    const { width, height } = element.getBoundingClientRect();
    const { outlineStyle, outlineWidth } = getComputedStyle(element.closest(".cm-editor") ?? element);
    return width > 0 && height > 0 && outlineStyle !== "none" && Number.parseFloat(outlineWidth) >= 2;
};

test("Tab moves through the page in order, is never trapped, and the focus is visible", async () => {
    await emptyScene(page);
    await runLines(page, "sphere crown");
    await page.getByRole("treeitem", { name: /^crown/ }).waitFor();
    await page.locator(".menu-title").first().focus();
    const parts = [".header"];
    const seen = new Set();
    for (let n = 0; n < 300; ++n) {
        await page.keyboard.press("Tab");
        const now = await focused();
        if (now.isBody || (now.part === ".header" && parts.length > 1)) {
            break;
        }
        await until(page, `the focus is visible: ${now.tag}`, isFocusSeen, undefined, 3000);
        seen.add(now.tag);
        if (now.part !== "" && parts.at(-1) !== now.part) {
            parts.push(now.part);
        }
    }
    assert.deepEqual(parts, [".header", ".side.left", ".picture-frame", ".tool-bar", ".bottom", ".side.right"]);
    assert.ok(seen.size > 30, `Tab reached ${seen.size} elements`);
});

test("reduced motion disables all transitions", async () => {
    const pitch = await page.evaluate(() => {
        globalThis.coppice.command("look-top");
        return globalThis.coppice.view.rig.pose.pitch;
    });
    assert.ok(Math.abs(pitch - Math.PI / 2) < 1e-9, "the view from above is shown at once");
    const moving = await page.evaluate(() =>
        [...document.querySelectorAll("*")]
            .filter((one) => {
                const { transitionDuration, animationName } = getComputedStyle(one);
                return /[1-9]/.test(transitionDuration) || animationName !== "none";
            })
            .map((one) => one.className),
    );
    assert.deepEqual(moving, []);
});

test("a page at 200 % zoom is complete and has no horizontal scrolling", async () => {
    await emptyScene(page);
    await runLines(page, "sphere crown");
    scheme = "dark";
    const small = await openPage(studio, { viewport: { width: 640, height: 400 }, colorScheme: "dark" }); // equivalent to 1280 x 800 magnified
    await small.evaluate(axe);
    assert.equal(await small.evaluate(() => document.documentElement.scrollWidth), 640);
    const picture = await small.locator(".picture-canvas canvas").boundingBox();
    assert.ok(picture.width > 600 && picture.height >= 180 && picture.y + picture.height < 330, `the view is visible at first: ${JSON.stringify(picture)}`);
    await checkPart("the magnified page", ["body"], small);
    for (const title of ["Objects", "History", "Growth", "Command", "Library", "Composition", "Check", "Display"]) {
        const heading = small.locator(".panel-title button", { hasText: new RegExp(`^${title}$`) });
        await heading.scrollIntoViewIfNeeded();
        const { x, y, width, height } = await heading.boundingBox();
        assert.ok(x >= 0 && x + width <= 640 && y >= 0 && y + height <= 400, `${title} can be reached`);
    }
    await small.locator(".menu-title", { hasText: "Crown" }).click();
    await small.getByRole("menuitem", { name: "Box", exact: true }).click(); // in a menu longer than the window
    await untilObject(small, "solid", "crown2");
    await small.getByRole("treeitem", { name: /^crown2/ }).click();
    await small.keyboard.press("Control+e");
    await dialog(small, "Export").getByRole("button", { name: "Export" }).click();
    await dialog(small, "Exported").getByRole("button", { name: "Close" }).click();
    await small.getByRole("button", { name: "Undo", exact: true }).click();
    await untilLines(small, ["sphere crown"]);
    await small.context().close();
});
