// Actions of users on the page, conditions to wait for, and checks of exported files.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile } from "node:fs/promises";
import { join } from "node:path";

const kTimeout = 30_000; // [ms]: machines may be slow; waiting ends as soon as the condition is satisfied

/** State of the document, for messages. */
async function pageState(page) {
    return page.evaluate(() => {
        const { state, messages, connection } = globalThis.coppice.store;
        const { statements, ran, running, error, objects } = state.peek();
        const lines = statements.map(({ text }) => text);
        return JSON.stringify({
            lines,
            ran,
            running,
            error,
            objects: objects.map(({ kind, name }) => `${kind} ${name}`),
            messages: messages.peek(),
            connection: connection.peek(),
        });
    });
}

/** Waits until a condition is satisfied in the page, and reports the condition on a timeout. */
export async function until(page, label, isSo, argument, timeout = kTimeout) {
    try {
        await page.waitForFunction(isSo, argument, { timeout });
    } catch (error) {
        throw new Error(`Timeout, waited until ${label}. The page has ${await pageState(page)} (${error.message.split("\n", 1)[0]})`);
    }
}

/** Waits until the document has these lines, and they have run as far as possible. */
export async function untilLines(page, lines) {
    const isSo = (wanted) => {
        const { statements, ran, running, error } = globalThis.coppice.store.state.peek();
        const texts = statements.map(({ text }) => text).filter((text) => text.trim() !== "");
        return JSON.stringify(texts) === JSON.stringify(wanted) && running === null && (error !== null || ran === statements.length);
    };
    await until(page, `the scene is ${JSON.stringify(lines)}`, isSo, lines);
}

/** Resets the scene, independent of the previous test. */
export async function emptyScene(page) {
    while ((await page.locator("dialog[open]").count()) > 0) {
        await page.keyboard.press("Escape");
    }
    await page.evaluate(() => globalThis.coppice.engine.request("open", { file: "" }));
    await untilLines(page, []);
}

/** Waits until an object of that name exists, and no command is running. */
export async function untilObject(page, kind, name) {
    const isSo = ([wanted, called]) => {
        const { objects, running } = globalThis.coppice.store.state.peek();
        return running === null && objects.some((object) => object.kind === wanted && object.name === called);
    };
    await until(page, `there is a ${kind} ${name}`, isSo, [kind, name]);
}

/** Waits until an object is selected. */
export async function untilSelected(page, kind, name) {
    const isSelected = ([wanted, called]) => {
        const { object } = globalThis.coppice.store.selection.peek();
        return object?.kind === wanted && object.name === called;
    };
    await until(page, `the ${kind} ${name} is selected`, isSelected, [kind, name]);
}

/** Waits until the page shows a message that contains this text. */
export async function untilMessage(page, text) {
    await until(page, `a message says "${text}"`, (wanted) => globalThis.coppice.store.messages.peek().some((one) => one.text.includes(wanted)), text);
}

/** The text in the editor, without the output of lines. */
export async function editorText(page) {
    return page.evaluate(() => {
        const lines = [...document.querySelectorAll(".cm-line")].map((line) => {
            const copy = line.cloneNode(true);
            copy.querySelectorAll(".cm-message").forEach((messagesOf) => messagesOf.remove());
            return copy.textContent;
        });
        return lines.join("\n");
    });
}

/** Types at the end of the text of the scene. */
export async function typeAtEnd(page, text) {
    await page.locator(".cm-content").click();
    await page.keyboard.press("Control+End");
    await page.keyboard.type(text);
}

/** Drops files on the page: [{name, bytes}]. */
export async function drop(page, ...files) {
    const all = files.map(({ name, bytes }) => ({ name, bytes: bytes.toString("base64") }));
    await page.evaluate((given) => {
        const data = new DataTransfer();
        for (const { name, bytes } of given) {
            data.items.add(new File([Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0))], name));
        }
        const target = document.querySelector(".picture-canvas");
        for (const type of ["dragenter", "dragover", "drop"]) {
            target.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
        }
    }, all);
}

/** Chooses an item of the menu bar with the mouse. */
export async function chooseItem(page, menu, item) {
    await page.locator(".menu-title", { hasText: new RegExp(`^${menu}$`) }).click();
    await page
        .locator(".menu-item > span:first-child", { hasText: item })
        .and(page.getByText(item, { exact: true }))
        .click();
}

/** The open dialog, by its title. */
export function dialog(page, title) {
    return page.getByRole("dialog", { name: title, exact: true });
}

/** The output of `coppice WORD...`. */
export function coppice(...words) {
    return new Promise((resolve) => {
        execFile(process.env.COPPICE, words, (error, stdout, stderr) => resolve({ code: error?.code ?? 0, text: stdout + stderr }));
    });
}

/**
 * Fails if `coppice check` finds an error in a mesh of the folder of the studio, or if the Khronos validator rejects its GLB
 * file.
 */
export async function checkFile(studio, file) {
    const path = join(studio.folder, file);
    const { code, text } = await coppice("check", path);
    assert.equal(code, 0, `coppice check ${file}: ${text}`);
    if (file.endsWith(".glb")) {
        const { validateBytes } = await import("../../../tests/gltf/node_modules/gltf-validator/index.js");
        const { issues } = await validateBytes(new Uint8Array(await readFile(path)));
        assert.equal(issues.numErrors + issues.numWarnings, 0, `the Khronos validator on ${file}: ${JSON.stringify(issues.messages)}`);
    }
}
