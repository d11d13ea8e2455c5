// Performs a menu item, or reports why it is not available.
import type { App } from "../../app";
import type { Kind, ObjectName } from "../../protocol";
import { runLine } from "../../tools/kit/gesture";
import { selectWhenCreated } from "../files/select_created";
import { confirm, showText } from "../files/dialog";
import { kDefaults, setDefault } from "../scene/defaults";
import { requestAnswers } from "./question_dialog";
import { filled, requestedKinds, partsOf } from "./fill";
import { type MenuItem, settingOf } from "./items";

/** Conditions of commands of the page itself; commands without an entry are always available. */
const kNeeds: Record<string, (app: App) => string> = {
    undo: ({ store }) => (store.state.peek().undo.length > 0 ? "" : "There is nothing to undo."),
    redo: ({ store }) => (store.state.peek().redo.length > 0 ? "" : "There is nothing to redo."),
    cancel: ({ store }) => (store.state.peek().running !== null ? "" : "No command is running."),
    export: ({ store }) => (store.state.peek().objects.length > 0 ? "" : "There is no object to export yet."),
    picture: ({ store }) => (store.state.peek().objects.length > 0 ? "" : "There is nothing to draw yet."),
};

const kAboutSelection = ["hide", "delete", "rename", "duplicate"];

/** The reason why an item is not available; empty if it is. */
export function unready(app: App, item: MenuItem, hasCommand: (id: string) => boolean): string {
    const { store } = app;
    const { object } = store.selection.peek();
    if (store.connection.peek() !== "ready" && item.does !== "set") {
        return "The studio is not connected.";
    }
    switch (item.does) {
        case "tool": {
            const tool = app.tools.find(({ id }) => id === item.text);
            return !tool ? `There is no tool ${item.text}.` : !tool.enabled || tool.enabled(app) ? "" : "Select an input for the tool first.";
        }
        case "page":
            if (!hasCommand(item.text)) {
                return `The page has no command ${item.text}.`;
            }
            return kAboutSelection.includes(item.text) && !object ? "Select an object first." : (kNeeds[item.text]?.(app) ?? "");
        case "line":
            return objectTrouble(app, item.text);
        case "set":
            return settingOf(item.text) ? "" : "This item should have the form COMMAND.ARGUMENT VALUE.";
        case "program":
            return !object && /\$\{(object|file\.\w+)\}/.test(item.text) ? "Select an object first." : "";
        default:
            return "";
    }
}

function objectTrouble(app: App, line: string): string {
    const kinds = requestedKinds(app.store.schema.peek(), line);
    if (!kinds || objectFor(app, kinds)) {
        return "";
    }
    return `Select ${kinds.length > 2 ? "an object" : kinds.map((kind) => (kind === "points" ? "points" : `a ${kind}`)).join(" or ")} first.`;
}

/** The object for an item: the selected one, or if its kind does not match the only object of these kinds. */
function objectFor(app: App, kinds: readonly Kind[]): ObjectName | undefined {
    const { object } = app.store.selection.peek();
    const all = app.store.state.peek().objects.filter(({ kind }) => kinds.includes(kind));
    return object && kinds.includes(object.kind) ? object : all.length === 1 ? { kind: all[0].kind, name: all[0].name } : undefined;
}

export function isChecked(item: MenuItem): boolean {
    const setting = settingOf(item.text);
    return setting !== null && kDefaults.peek().get(setting.key) === setting.value;
}

export function perform(app: App, item: MenuItem): void {
    switch (item.does) {
        case "tool":
            app.take(item.text);
            break;
        case "page":
            app.command(item.text);
            break;
        case "line":
            void performLine(app, item);
            break;
        case "set": {
            const setting = settingOf(item.text);
            if (setting) {
                setDefault(setting.key, isChecked(item) ? null : setting.value);
            }
            break;
        }
        case "program":
            void performProgram(app, item);
            break;
        case "separator":
            break;
    }
}

async function performLine(app: App, item: MenuItem): Promise<void> {
    const parts = partsOf(item.text);
    const schema = app.store.schema.peek();
    const kinds = requestedKinds(schema, item.text);
    const about = kinds ? objectFor(app, kinds) : undefined;
    const fill = (answers: readonly string[]) => filled(parts, { object: about?.name ?? "", answers }, schema);
    if (!parts.some(({ is }) => is === "ask")) {
        const ran = await runLine(app, fill([]), about);
        await selectCreated(app, ran?.names ?? []);
        return;
    }
    const created = await requestAnswers(app, item.label, parts, async (answers) => {
        const { message, names } = await app.engine.run(fill(answers), about);
        if (message) {
            app.store.notify(message);
        }
        return names;
    });
    await selectCreated(app, created ?? []);
}

// The next item uses the object that this one created.
async function selectCreated(app: App, created: readonly string[]): Promise<void> {
    if (created.length > 0) {
        await selectWhenCreated(app, ({ name }) => name === created.at(-1));
    }
}

const kAllowed = new Set<string>(); // programs that were started since the page was opened

async function performProgram(app: App, item: MenuItem): Promise<void> {
    const text = `The menu item "${item.label}" starts another program:\n${item.text}`;
    if (!kAllowed.has(item.text) && !(await confirm("Start this program?", text, "Start it"))) {
        return;
    }
    kAllowed.add(item.text);
    try {
        app.store.notify(`${item.label} runs…`);
        const fields = { item: item.number, ...app.store.selection.peek().object };
        const { text, status } = await app.engine.request<{ text: string; status: number | null }>("program", fields);
        if (text.trim() || status) {
            await showText(item.label, status ? `${text}\nIt ended with status ${status}.`.trim() : text.trim());
        }
    } catch (error) {
        app.store.notify((error as Error).message, "error");
    }
}
