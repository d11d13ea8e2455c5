// A studio and a browser for the tests in this folder: COPPICE names the program.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { chromium } from "playwright-core";

const kPrograms = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const kArguments = [
    "--no-sandbox",
    "--use-angle=gl-egl", // Mesa's rasterizer: three times as fast as SwiftShader
    "--ignore-gpu-blocklist",
    "--disable-gpu-compositing", // the rest of the page is composited by the CPU: a fifth less time
    "--disable-quic",
    "--webgl-antialiasing-mode=none", // because of its cost
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/**
 * Starts `coppice studio` on a temporary folder, or on a file in it, as a child of the test; with `before`, in the state
 * directory of a killed one.
 */
export async function startStudio(options = [], folder = undefined, before = undefined, file = "") {
    const home = before?.home ?? (await mkdtemp(join(tmpdir(), "coppice studio ")));
    const work = folder ?? join(home, "work");
    await mkdir(work, { recursive: true });
    const env = { ...process.env, XDG_STATE_HOME: home, XDG_RUNTIME_DIR: home, XDG_CONFIG_HOME: join(home, "config") };
    const page = process.env.COPPICE_PAGE ? ["--page", process.env.COPPICE_PAGE] : []; // instead of the page in the program
    const child = spawn(process.env.COPPICE, ["studio", join(work, file), "--no-browser", ...page, ...options], { env, stdio: ["ignore", "pipe", "inherit"] });
    const line = await new Promise((resolve, reject) => {
        let text = "";
        child.stdout.on("data", (piece) => {
            text += piece;
            if (text.includes("\n")) {
                resolve(text.split("\n", 1)[0]);
            }
        });
        child.on("exit", (code) => reject(new Error(`the studio ended with ${code}: ${text}`)));
    });
    const doorway = line.split(": ").at(-1);
    const address = /url=([^"]+)/.exec(await readFile(doorway, "utf8"))[1];
    return {
        address,
        folder: work,
        home,
        child,
        write: (name, bytes) => writeFile(join(work, name), bytes),
        read: (name) => readFile(join(work, name)),
        /** Kills the process like a crash; its state remains. */
        async kill() {
            const ended = new Promise((resolve) => child.once("exit", resolve));
            child.kill("SIGKILL");
            await ended;
        },
        async end(signal = "SIGINT") {
            const ended = new Promise((resolve) => child.once("exit", resolve));
            child.kill(signal);
            const code = await ended;
            await rm(home, { recursive: true, force: true });
            return code;
        },
    };
}

let browser;

/** One browser for all tests of a file. */
export async function startBrowser() {
    const executablePath = kPrograms.find((path) => existsSync(path));
    if (!executablePath && !process.env.CI) {
        console.log("There is no browser here (Debian's chromium); these tests are skipped.");
        process.exit(0);
    }
    process.env.LIBGL_ALWAYS_SOFTWARE = "1";
    browser = await chromium.launch({ executablePath, args: kArguments });
    return browser;
}

export async function endBrowser() {
    await browser?.close();
}

/** A studio for all tests of a file, and a browser. */
export function withStudio(begin) {
    let studio;
    before(async () => {
        await startBrowser();
        studio = await startStudio();
        await begin(studio);
    });
    after(async () => {
        await endBrowser();
        await studio?.end();
    });
}

/** A tab with the page of the studio, connected and drawn; its errors fail the test that checks `complaints`. */
export async function openPage(studio, options = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, deviceScaleFactor: 1, ...options });
    const page = await context.newPage();
    const complaints = [];
    page.on("console", (message) => {
        if (message.type() === "error") {
            complaints.push(`${message.text()} ${message.location().url}`);
        }
    });
    page.on("pageerror", (error) => complaints.push(String(error)));
    await page.goto(options.address ?? studio.address);
    await page.waitForFunction(() => globalThis.coppice?.store.connection.value === "ready" && globalThis.coppice.store.schema.value.length > 0);
    return Object.assign(page, { complaints });
}

/** Waits until the engine has finished all requests, and all results are drawn. */
export async function settled(page) {
    await page.evaluate(() => globalThis.coppice.engine.request("ping"));
    await page.waitForFunction(() => globalThis.coppice.view.idle && globalThis.coppice.engine.idle, undefined, { timeout: 60_000 });
}

/** The lines of the document. */
export const lines = (page) => page.evaluate(() => globalThis.coppice.store.state.value.statements.map((statement) => statement.text));

/** Runs lines like a panel, as the initial state of a test. */
export async function runLines(page, ...all) {
    for (const line of all) {
        await page.evaluate((text) => globalThis.coppice.engine.run(text), line);
    }
    await settled(page);
}

/** Position of a point of the scene in the page. */
export async function placeOf(page, point) {
    return page.evaluate((at) => {
        const { view } = globalThis.coppice;
        const box = view.element().getBoundingClientRect();
        const [x, y] = view.toPixels(at);
        return { x: box.left + x, y: box.top + y };
    }, point);
}

/** Moves the mouse with its button pressed along positions of the page. */
export async function drag(page, places, steps = 6) {
    await page.mouse.move(places[0].x, places[0].y);
    await page.mouse.down();
    for (const place of places.slice(1)) {
        await page.mouse.move(place.x, place.y, { steps });
    }
    await page.mouse.up();
}

/** Unfolds a panel at the side of the view by its title, if it is folded. */
export async function openPanel(page, title) {
    const heading = page.locator(".panel-title button", { hasText: new RegExp(`^${title}$`) });
    if ((await heading.getAttribute("aria-expanded")) === "false") {
        await heading.click();
    }
}
