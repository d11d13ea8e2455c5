// Files: scenes, imports, exports, images, films, and the menu file.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, before, beforeEach, test } from "node:test";
import { fileURLToPath } from "node:url";
import { PNG } from "pngjs";
import { endBrowser, lines, openPage, runLines, settled, startBrowser, startStudio } from "./browser.mjs";
import { chooseItem, coppice, dialog, drop, emptyScene, checkFile, typeAtEnd, until, untilLines, untilObject, untilMessage } from "./user.mjs";

const kRoot = fileURLToPath(new URL("../../../", import.meta.url));
const kData = join(kRoot, "../shared/data"); // files of other programs, if available
const kMenu = `
[Mine]
Ball of mine = line sphere \${new ball} radius=\${ask Its radius, 2}
Echo = program /bin/echo hello \${object}
Finer from now on = set mesh.levels 4
this is no item
`;

let studio;
let page;
let own;

before(async () => {
    await startBrowser();
    own = await mkdtemp(join(tmpdir(), "coppice menu "));
    await writeFile(join(own, "mine.menu"), kMenu);
    studio = await startStudio(["--menu", join(own, "mine.menu")]);
    page = await openPage(studio);
});

beforeEach(() => emptyScene(page));

after(async () => {
    await endBrowser();
    await studio?.end();
    await rm(own, { recursive: true, force: true });
});

const example = async (name) => ({ name, bytes: await readFile(join(kRoot, "examples", name)) });
const documentName = () => page.locator(".document").textContent();
const untilNamed = (name) => until(page, `the page shows the name "${name}"`, (wanted) => document.querySelector(".document").textContent === wanted, name);

test("a scene is saved, saved as another file, replaced by a new one and opened again", async () => {
    await typeAtEnd(page, "sphere crown\n");
    await untilLines(page, ["sphere crown"]);
    assert.equal(await documentName(), "Untitled scene (not saved)");
    await page.keyboard.press("Control+s");
    await dialog(page, "Save the scene").getByLabel("Name in the folder").fill("first");
    await page.keyboard.press("Enter");
    await untilNamed("first.coppice");
    assert.equal(String(await studio.read("first.coppice")).trim(), "sphere crown");

    await typeAtEnd(page, "scale crown 2\n");
    await untilNamed("first.coppice (not saved)");
    await page.keyboard.press("Control+s");
    await untilNamed("first.coppice");
    assert.equal(String(await studio.read("first.coppice")).trim(), "sphere crown\nscale crown 2");

    await typeAtEnd(page, "translate crown 0 0 4\n");
    await chooseItem(page, "File", "Save as…");
    await dialog(page, "Save the scene").getByLabel("Name in the folder").fill("second.coppice");
    await dialog(page, "Save the scene").getByRole("button", { name: "Save" }).click();
    await untilNamed("second.coppice");
    assert.equal(String(await studio.read("second.coppice")).trim(), "sphere crown\nscale crown 2\ntranslate crown 0 0 4");

    await chooseItem(page, "File", "New scene");
    await untilNamed("Untitled scene");
    await untilLines(page, []);
    await page.keyboard.press("Control+o");
    await dialog(page, "Open a scene")
        .getByRole("option", { name: /^second/ })
        .waitFor();
    await dialog(page, "Open a scene").getByLabel("Search").fill("first");
    await page.keyboard.press("Enter");
    await untilNamed("first.coppice");
    await untilLines(page, ["sphere crown", "scale crown 2"]);
    assert.equal(await page.locator("dialog[open]").count(), 0);
    assert.deepEqual(page.complaints, []);
});

test("a scene overwrites another file only after confirmation", async () => {
    await studio.write("there.coppice", "sphere there\n");
    await runLines(page, "sphere mine");
    await page.keyboard.press("Control+Shift+s");
    await dialog(page, "Save the scene").getByLabel("Name in the folder").fill("there");
    await page.keyboard.press("Enter");
    const question = dialog(page, "Replace the file?");
    await question.waitFor();
    await page.keyboard.press("Enter"); // Enter alone does not confirm
    await question.waitFor({ state: "detached" });
    assert.equal(String(await studio.read("there.coppice")), "sphere there\n");
    await page.keyboard.press("Enter");
    await question.getByRole("button", { name: "Replace" }).click();
    await untilNamed("there.coppice");
    assert.equal(String(await studio.read("there.coppice")).trim(), "sphere mine");
});

// Kind and name of the object from each file.
const kImports = {
    "swc/modulartree_small.swc": ["skeleton", "modulartree_small"],
    "qsm/itsme_tree_1_qsm.mat": ["skeleton", "itsme_tree_1_qsm"],
    "qsm/qsm2r_QSM_Juglans_regia_S.cylinders.csv": ["skeleton", "qsm2r_QSM_Juglans_regia_S.cylinders"],
    "qsm/archi_Tree_1_TreeQSM.txt": ["skeleton", "archi_Tree_1_TreeQSM"],
    "rsml/archidart_monocot.rsml": ["skeleton", "archidart_monocot"],
    "mtg/plantscan3d_A3B4.mtg": ["skeleton", "plantscan3d_A3B4"],
    "tree_mesh/kaykit_tree_single_B.obj": ["mesh", "kaykit_tree_single_B"],
    "tree_mesh/kenney_grass-trees.glb": ["mesh", "kenney_grass-trees"],
    "closed_mesh/cgal_blobby_3cc.off": ["mesh", "cgal_blobby_3cc"],
    "closed_mesh/potpourri3d_bunny_small.ply": ["mesh", "potpourri3d_bunny_small"],
    "cloud/adtree_tiny.xyz": ["points", "adtree_tiny"],
    "cloud/treels_pine.laz": ["points", "treels_pine"],
    "qsm/archi_Tree_1_point_cloud.las": ["points", "archi_Tree_1_point_cloud"],
    "cloud/itsme_pc_tree.ply": ["points", "itsme_pc_tree"],
};

test("dropped files of other programs are imported by their contents", async (context) => {
    if (!existsSync(kData)) {
        context.skip("There is no ../shared/data here.");
        return;
    }
    const names = Object.keys(kImports);
    const files = await Promise.all(names.map(async (name) => ({ name: basename(name), bytes: await readFile(join(kData, name)) })));
    await drop(page, ...files);
    const question = dialog(page, "How should these files be imported?"); // of meshes and points, which may contain a tree
    await question.waitFor();
    assert.equal(await question.getByRole("group").count(), 8);
    await question.getByRole("button", { name: "Import" }).click();
    for (const [kind, name] of Object.values(kImports)) {
        await untilObject(page, kind, name);
    }
    await until(page, "imports are finished", () => document.querySelector(".import-status").hidden);
    const found = await page.evaluate(() => globalThis.coppice.store.messages.peek().filter(({ level }) => level === "error"));
    assert.deepEqual(found, []);
});

test("dropped trees, sketches and scenes of this project are opened", async () => {
    await drop(page, await example("oak.swc"));
    await untilObject(page, "skeleton", "oak");
    await settled(page);
    assert.deepEqual(await lines(page), ["loadtree oak oak.swc"]);

    await drop(page, await example("fork.sketch.json"));
    await page
        .getByText(/strokes?/i)
        .first()
        .waitFor();
    await page.evaluate(() => globalThis.coppice.take("select"));

    await drop(page, await example("crown.coppice"));
    await dialog(page, "Open crown.coppice?").getByRole("button", { name: "Open it" }).click();
    await untilNamed("crown.coppice");
    await page.evaluate(() => globalThis.coppice.engine.cancel());
});

test("a file that is dropped again is imported again if its bytes differ", async () => {
    await studio.write("again.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.1 1\n");
    await runLines(page, "loadtree again again.swc", "radii again tip_radius=0.02");
    const longer = { name: "again.swc", bytes: Buffer.from("1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.1 1\n3 1 0 0 2 0.1 2\n") };
    await drop(page, longer);
    const question = dialog(page, "Replace the file?");
    assert.match(await question.textContent(), /The scene uses it/);
    await question.getByRole("button", { name: "Replace" }).click();
    await untilMessage(page, "again.swc was replaced");
    await until(page, "the tree comes from the new file", () => globalThis.coppice.store.find("skeleton", "again")?.count === 3);
    await untilLines(page, ["loadtree again again.swc", "radii again tip_radius=0.02"]);
    await drop(page, longer); // same content: a second tree from it, without a question
    await untilObject(page, "skeleton", "again2");
    await drop(page, { name: "again.swc", bytes: Buffer.from("1 1 0 0 0 0.1 -1\n2 1 0 0 3 0.1 1\n") });
    await question.getByRole("button", { name: "Keep both" }).click();
    await untilObject(page, "skeleton", "again-2");
});

test("an unreadable file is reported with the reason", async () => {
    await drop(
        page,
        { name: "trees.zip", bytes: Buffer.from("PK") },
        { name: "empty.swc", bytes: Buffer.alloc(0) },
        { name: "film.mov", bytes: Buffer.from("x") },
    );
    await untilMessage(page, "trees.zip is compressed; unpack it first.");
    await untilMessage(page, "empty.swc is empty.");
    await untilMessage(page, "film.mov is not in a supported format.");
    assert.deepEqual(await lines(page), []);
});

test("a skeleton is extracted from a dropped mesh", async () => {
    await coppice("mesh", join(kRoot, "examples/fork.swc"), "-o", join(own, "wood.ply"), "--quiet");
    await drop(page, { name: "wood.ply", bytes: await readFile(join(own, "wood.ply")) });
    const question = dialog(page, "How should wood.ply be imported?");
    await question.getByLabel("Extract the skeleton of the tree").check();
    await page.keyboard.press("Enter");
    await untilObject(page, "skeleton", "wood");
    assert.deepEqual(await lines(page), ["extract wood wood.ply"]);
});

async function exportAs(format, name) {
    const form = dialog(page, "Export");
    await form.waitFor();
    await form.getByLabel("Format").selectOption(format);
    await form.getByLabel("File in the folder").fill(name);
    await page.keyboard.press("Enter");
    const done = dialog(page, "Exported");
    await done.waitFor();
    return done;
}

test("objects are exported in every format, and the files are valid", async () => {
    await studio.write("fork.swc", (await example("fork.swc")).bytes);
    await runLines(page, "loadtree fork fork.swc", "sphere crown", "pointset generate crown count=200");
    await page.getByRole("treeitem", { name: /^fork/ }).click();
    await page.locator(".picture-canvas canvas").focus();
    await page.keyboard.press("Control+e");
    for (const ending of [".glb", ".ply", ".obj", ".stl", ".usda"]) {
        const done = await exportAs(`surface${ending}`, `timber${ending}`);
        assert.match(await done.locator(".verdict.good").textContent(), /\w{4}/, "the check reports the quality of the surface");
        if (ending !== ".usda") {
            // the check does not read this format
            await checkFile(studio, `timber${ending}`);
        }
        await done.getByRole("button", { name: "Export more" }).click();
    }
    const nodes = await page.evaluate(() => globalThis.coppice.store.find("skeleton", "fork").count);
    for (const ending of [".swc", ".json", ".obj", ".ply", ".csv", ".rsml", ".mtg"]) {
        const file = `bones${ending}`;
        const done = await exportAs(`skeleton${ending}`, file);
        const { code, text } = await coppice("info", join(studio.folder, file));
        assert.equal(code, 0, text);
        assert.match(text, /nodes/, `${file} holds a skeleton of some ${nodes} nodes: ${text}`);
        await done.getByRole("button", { name: "Export more" }).click();
    }
    await dialog(page, "Export").getByLabel("fork skeleton").uncheck();
    await dialog(page, "Export").getByLabel("crown points").check();
    for (const ending of [".xyz", ".ply"]) {
        const done = await exportAs(`points${ending}`, `leaves${ending}`);
        assert.match((await coppice("info", join(studio.folder, `leaves${ending}`))).text, /200/);
        await done.getByRole("button", { name: "Export more" }).click();
    }
    await dialog(page, "Export").getByLabel("crown points").uncheck();
    await dialog(page, "Export").getByLabel("crown solid").check();
    const done = await exportAs("surface.glb", "leaves");
    await checkFile(studio, "leaves.glb");
    await done.getByRole("button", { name: "Export more" }).click();
    await dialog(page, "Export").getByLabel("File in the folder").fill("timber");
    await page.keyboard.press("Enter");
    await dialog(page, "Replace the file?").getByRole("button", { name: "Replace" }).click();
    await done.waitFor();
    await checkFile(studio, "timber.glb");
    const [download] = await Promise.all([page.waitForEvent("download"), done.getByRole("button", { name: "Download timber.glb" }).click()]);
    assert.equal(download.suggestedFilename(), "timber.glb");
    await page.keyboard.press("Escape");
    await done.waitFor({ state: "detached" });
    assert.deepEqual(page.complaints, []);
});

test("the path tracer draws the objects of the view", async () => {
    await studio.write("fork.swc", (await example("fork.swc")).bytes);
    await runLines(page, "loadtree fork fork.swc");
    await chooseItem(page, "File", "Picture…");
    const form = dialog(page, "Image by the path tracer");
    await form.getByLabel("Width").fill("160");
    await form.getByLabel("Height").fill("120");
    await form.getByLabel("Rays for each pixel").fill("1");
    await form.getByRole("button", { name: "Draw" }).click();
    const done = dialog(page, "picture.png");
    await done.getByRole("img").waitFor();
    await page.keyboard.press("Escape");
    const { width, height, data } = PNG.sync.read(await studio.read("picture.png"));
    assert.deepEqual([width, height], [160, 120]);
    assert.ok(new Set(data.filter((_, at) => at % 4 === 0)).size > 20, "the image has many shades");
});

test("a tree is animated by keys, played and exported as a film", async () => {
    await studio.write("fork.swc", (await example("fork.swc")).bytes);
    await runLines(page, "loadtree fork fork.swc", "edit rotate fork tips 25");
    await chooseItem(page, "File", "Animation…");
    const panel = page.getByRole("tabpanel", { name: "Animation" });
    await panel.getByLabel("Lasts [s]").fill("1");
    await panel.getByLabel("Frames/s").fill("4");
    await panel.getByRole("button", { name: "Add a key here" }).click(); // at rest, at the start
    await panel.getByRole("slider", { name: "Time in the film" }).focus();
    await page.keyboard.press("End");
    await panel.getByRole("button", { name: "Convert the last edit to a key" }).click();
    await untilLines(page, ["loadtree fork fork.swc"]);
    assert.match(await panel.getByLabel("Edits").inputValue(), /^rotate tips 25$/);
    await panel.getByRole("button", { name: "Play" }).click();
    await until(page, "all frames are available", () => /^(\d+) of \1$/.test(document.querySelector(".frames-here")?.textContent));
    await panel.getByRole("button", { name: "Pause" }).click();
    await panel.getByRole("button", { name: "At rest" }).click();
    await panel.getByRole("button", { name: "Export…" }).click();
    const form = dialog(page, "Export the film");
    await form.getByLabel("Width").fill("96");
    await form.getByLabel("Height").fill("96");
    await form.getByLabel("Rays for each pixel").fill("1");
    await form.getByRole("button", { name: "Export" }).click();
    const done = page.getByRole("dialog", { name: /^The film fork\.gif/ });
    await done.getByRole("img").waitFor();
    await page.keyboard.press("Escape");
    const film = await studio.read("fork.gif");
    assert.equal(film.subarray(0, 6).toString("latin1"), "GIF89a");
    const frames = film.toString("latin1").split("\x21\xf9\x04").length - 1; // one control block before each frame
    assert.ok(frames >= 4, `the film has ${frames} frames`);
    await page.getByRole("tab", { name: "Scene" }).click();
});

test("the user menu runs lines, starts programs after confirmation and sets defaults of forms", async () => {
    await untilMessage(page, "mine.menu:6"); // an invalid line is skipped
    await chooseItem(page, "Mine", "Ball of mine");
    await dialog(page, "Ball of mine").getByLabel("Its radius").fill("1.5");
    await page.keyboard.press("Enter");
    await untilLines(page, ["sphere ball radius=1.5"]);
    await chooseItem(page, "Mine", "Echo");
    const question = dialog(page, "Start this program?");
    assert.match(await question.textContent(), /\/bin\/echo hello/);
    await question.getByRole("button", { name: "Start it" }).click();
    await dialog(page, "Echo").getByText("hello ball").waitFor();
    await page.keyboard.press("Escape");
    await chooseItem(page, "Mine", "Finer from now on");
    await page.locator(".menu-title", { hasText: "Mine" }).click();
    assert.equal(await page.getByRole("menuitemcheckbox", { name: "Finer from now on" }).getAttribute("aria-checked"), "true");
    await page.keyboard.press("Escape");
});
