// Failures: killed studios, crashed tabs and cut connections. No data is lost, and no command is run twice.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { endBrowser, lines, openPage, runLines, settled, startBrowser, startStudio } from "./browser.mjs";
import { dialog, editorText, emptyScene, typeAtEnd, until, untilLines, untilMessage } from "./user.mjs";

let studio;
let page;

/** A separate tab that draws as little as possible. */
async function openTab(from = studio, options = {}) {
    const on = await openPage(from, { viewport: { width: 1000, height: 700 }, deviceScaleFactor: 0.25, reducedMotion: "reduce", ...options });
    await on.evaluate(() => (globalThis.coppice.view.display.shadow.value = false));
    return on;
}

before(async () => {
    await startBrowser();
    studio = await startStudio();
    page = await openTab();
});

after(async () => {
    await endBrowser();
    await studio?.end();
});

const untilConnected = (on) =>
    until(on, "the page is connected", () => globalThis.coppice?.store.connection.peek() === "ready" && globalThis.coppice.store.schema.peek().length > 0);
const untilNotified = (on, text) => on.locator(".connection", { hasText: text }).waitFor();
const isDrawn = (on, name) =>
    until(on, `${name} is drawn`, (called) => globalThis.coppice.view.geometry({ kind: "solid", name: called })?.arrays.position.length > 0, name);

/** A page with a connection that can be cut: `cable.eats` selects the messages that are lost before that. */
async function openOnCable(context) {
    const on = await context.newPage();
    const cable = { isCut: false, eats: () => false, ends: [], sent: [] };
    await on.routeWebSocket(/\/ws$/, (socket) => {
        if (cable.isCut) {
            void socket.close({ code: 1001 });
            return;
        }
        const server = socket.connectToServer();
        cable.ends.push(
            () => socket.close({ code: 1001 }),
            () => server.close(),
        );
        const pass = (to) => (data) => {
            const message = typeof data === "string" ? JSON.parse(data) : {};
            if (to === server) {
                cable.sent.push(message);
            }
            if (!cable.eats(message)) {
                to.send(data);
            }
        };
        socket.onMessage(pass(server));
        server.onMessage(pass(socket));
    });
    await on.goto(studio.address);
    await untilConnected(on);
    return { on, cable };
}

/** Runs a line without waiting for it; `answer` waits. */
const request = (on, line) =>
    on.evaluate((text) => {
        globalThis.answer = null;
        globalThis.coppice.engine
            .run(text)
            .then(
                () => "done",
                (error) => error.message,
            )
            .then((answer) => (globalThis.answer = answer));
    }, line);

async function answer(on) {
    await until(on, "the request is answered", () => globalThis.answer !== null);
    return on.evaluate(() => globalThis.answer);
}

async function cut(cable) {
    cable.isCut = true;
    await Promise.all(cable.ends.splice(0).map((end) => end()));
    cable.eats = () => false;
}

test("the file given at the start of the studio is imported once", async () => {
    const folder = await mkdtemp(join(tmpdir(), "coppice first "));
    await writeFile(join(folder, "my tree.swc"), "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.1 1\n");
    await writeFile(join(folder, "film.mov"), "x");
    const begun = await startStudio([], folder, undefined, "my tree.swc");
    const first = await openTab(begun);
    await untilLines(first, ['loadtree my_tree "my tree.swc"']);
    assert.equal(await first.evaluate(() => location.hash), "");
    await emptyScene(first);
    await first.reload();
    await untilConnected(first);
    await settled(first);
    assert.deepEqual(await lines(first), [], "a reloaded tab begins without the address parameters");
    const token = begun.address.replace(/&import=.*/, "");
    const other = await openTab(begun, { address: `${token}&import=film.mov` });
    await untilMessage(other, "film.mov is not in a supported format.");
    await other.goto("about:blank");
    await other.goto(`${token}&import=gone.ply`);
    await untilMessage(other, "gone.ply");
    assert.deepEqual(await lines(other), []);
    await begun.end();
    await rm(folder, { recursive: true });
});

test("a killed studio restores everything after a restart", async () => {
    await emptyScene(page);
    await typeAtEnd(page, "sphere crown\nscale crown 2\n");
    await untilLines(page, ["sphere crown", "scale crown 2"]);
    await page.keyboard.type("sphere oth"); // an incomplete line
    const { home, folder } = studio;
    const port = new URL(studio.address).port;
    await studio.kill();
    await untilNotified(page, "Connection lost");
    await page.keyboard.type("er");
    assert.equal(await editorText(page), "sphere crown\nscale crown 2\nsphere oth", "state that cannot be stored is refused");

    studio = await startStudio(["--port", port], folder, { home });
    await untilMessage(page, "open it again from the terminal");
    await untilNotified(page, "No longer connected");
    const next = await openTab();
    await untilLines(next, ["sphere crown", "scale crown 2"]);
    await isDrawn(next, "crown");
    const notice = next.getByRole("complementary", { name: "Recovered scene" });
    await notice.getByText("was ended before this scene was saved").waitFor();
    assert.match(await next.locator(".document").textContent(), /not saved/);

    await notice.getByRole("button", { name: "Start with an empty scene" }).click();
    await untilLines(next, []);
    await notice.waitFor({ state: "detached" });
    await next.keyboard.press("Control+z");
    await untilLines(next, ["sphere crown", "scale crown 2"]);
    await next.keyboard.press("Control+s");
    await dialog(next, "Save the scene").getByLabel("Name in the folder").fill("kept");
    await next.keyboard.press("Enter");
    await until(next, "it is saved", () => globalThis.coppice.store.state.peek().saved);

    await studio.kill();
    studio = await startStudio(["--port", port], folder, { home });
    const last = await openTab();
    await settled(last);
    assert.deepEqual(await lines(last), [], "the saved state is in its file");
    assert.equal(await last.getByRole("complementary", { name: "Recovered scene" }).count(), 0);
    for (const one of [page, next]) {
        await one.context().close();
    }
    page = last;
});

test("a crashed tab and a closed tab restore their state", async () => {
    await emptyScene(page);
    await runLines(page, "sphere crown", "scale crown 2");
    const crashing = await page.context().newPage();
    await crashing.goto(studio.address);
    await untilConnected(crashing);
    await crashing.evaluate(() => void globalThis.coppice.engine.run("translate crown 0 0 3"));
    await untilLines(page, ["sphere crown", "scale crown 2", "translate crown 0 0 3"]);
    const session = await page.context().newCDPSession(crashing);
    const crashed = crashing.waitForEvent("crash");
    session.send("Page.crash").catch(() => undefined);
    await crashed;
    await crashing.close();
    await page.close({ runBeforeUnload: false });
    page = await openTab();
    await untilLines(page, ["sphere crown", "scale crown 2", "translate crown 0 0 3"]);
    await isDrawn(page, "crown");
    await page.keyboard.press("Control+z");
    await untilLines(page, ["sphere crown", "scale crown 2"]);
    await typeAtEnd(page, "translate cr");
    page.once("dialog", (dialog) => dialog.accept()); // "leave the page?"
    await page.reload(); // the token is no longer in the address
    await untilConnected(page);
    await untilLines(page, ["sphere crown", "scale crown 2"]);
    await isDrawn(page, "crown");
    assert.match(await editorText(page), /^translate cr$/m, "an incomplete typed line is restored");
});

test("a request during a lost connection is executed once", async () => {
    await emptyScene(page);
    await runLines(page, "sphere crown");
    const { on, cable } = await openOnCable(page.context());
    const back = async () => {
        cable.isCut = false;
        await untilConnected(on);
        assert.equal(await answer(on), "done");
    };

    cable.eats = ({ re, statement }) => re !== undefined && statement !== undefined; // the response does not arrive
    await request(on, "translate crown 1 0 0");
    await untilLines(page, ["sphere crown", "translate crown 1 0 0"]);
    await cut(cable);
    await untilNotified(on, "Connection lost");
    await back();
    await cut(cable);

    await untilNotified(on, "Connection lost");
    assert.ok(await on.getByRole("button", { name: "Undo", exact: true }).isDisabled(), "edits wait");
    assert.match(await on.evaluate(() => globalThis.coppice.engine.run("sphere lost").catch(({ message }) => message)), /not connected/);
    await runLines(page, "sphere added center=4,0,0");
    await back();
    await untilLines(on, ["sphere crown", "translate crown 1 0 0", "sphere added center=4,0,0"]);
    await isDrawn(on, "added");

    cable.eats = ({ type }) => type === "run"; // the request does not arrive
    await request(on, "scale crown 2");
    while (cable.sent.at(-1)?.line !== "scale crown 2") {
        await settled(page);
    }
    await cut(cable);
    await back();
    const all = ["sphere crown", "translate crown 1 0 0", "scale crown 2", "sphere added center=4,0,0"];
    assert.deepEqual((await lines(on)).toSorted(), all.toSorted());
    assert.equal(cable.sent.filter(({ line }) => line === "translate crown 1 0 0").length, 2, "it was requested twice, and run once");
    await on.close();
});

test("a command continues while a tab is closed, and the reopened tab can stop it", async () => {
    await emptyScene(page);
    await runLines(page, "sphere crown radius=3 center=0,0,3", "pointset generate crown count=20000", "delete crown kind=solid");
    const { on, cable } = await openOnCable(page.context());
    const runs = (here) => until(here, "it grows", () => globalThis.coppice.store.state.peek().running === 3);
    await request(on, "grow tree crown influence_radius=3 kill_radius=0.005 step=0.002");
    await runs(page);
    await cut(cable);
    await untilNotified(on, "Connection lost");
    cable.isCut = false;
    await untilConnected(on);
    await runs(on);
    await on.locator(".status").getByRole("button", { name: "Stop" }).click();
    assert.match(await answer(on), /interrupted/);
    await untilLines(page, ["sphere crown radius=3 center=0,0,3", "pointset generate crown count=20000", "delete crown kind=solid"]);
    await on.close();
});

test("two tabs show the same scene, and each can undo changes of the other", async () => {
    await emptyScene(page);
    const other = await openTab();
    await runLines(page, "sphere mine", "scale mine 2");
    await untilLines(other, ["sphere mine", "scale mine 2"]);
    await isDrawn(other, "mine");
    await other.getByRole("treeitem", { name: /^mine/ }).click();
    assert.equal(await page.evaluate(() => globalThis.coppice.store.selection.peek().object), null, "each has its own selection");

    const button = other.getByRole("button", { name: "Undo", exact: true });
    assert.match(await button.getAttribute("title"), /scale mine 2/);
    await button.click();
    await untilLines(page, ["sphere mine"]);
    await page.getByRole("button", { name: "Redo", exact: true }).click();
    await untilLines(other, ["sphere mine", "scale mine 2"]);
    await runLines(other, "delete mine");
    await until(page, "it is removed here too", () => globalThis.coppice.view.geometry({ kind: "solid", name: "mine" }) === undefined);
    await page.keyboard.press("Control+z");
    await isDrawn(other, "mine");
    const boundsOf = (on) => on.evaluate(() => globalThis.coppice.store.find("solid", "mine").bounds);
    assert.deepEqual(await boundsOf(other), await boundsOf(page));
    await other.context().close();
    assert.deepEqual(page.complaints, []);
});
