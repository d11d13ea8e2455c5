// Actions for an object; each ends as a line of the scene, or renames the object in all lines.
import type { App } from "../../../app";
import type { Kind, ObjectName } from "../../../protocol";
import { kKinds } from "../../../script/commands";
import { isObjectName, renamed } from "../../../script/names";
import { textOf } from "../../../script/pieces";
import { runLine } from "../../../tools/kit/gesture";
import { commandLine, kindOption, newName } from "../../../tools/kit/words";
import { editorOf } from "../editor/session";
import { idOf } from "./model";
import { requestName } from "./rename";

function kindOf(app: App, object: ObjectName): { kind?: Kind } {
    return kindOption(app.store.state.peek().objects, object, kKinds);
}

/** Whether an object can be seen: a material has no shape. */
export function isVisible({ kind }: ObjectName): boolean {
    return kind !== "material";
}

export function isHidden(app: App, object: ObjectName): boolean {
    return app.store.hidden.value.has(idOf(object));
}

export function toggleHidden(app: App, object: ObjectName): void {
    const hidden = new Set(app.store.hidden.peek());
    if (!hidden.delete(idOf(object)) && isVisible(object)) {
        hidden.add(idOf(object));
    }
    app.store.hidden.value = hidden;
}

export function select(app: App, { kind, name }: ObjectName): void {
    const { extent } = app.store.selection.peek();
    app.store.selection.value = { object: { kind, name }, nodes: [], extent };
}

export async function remove(app: App, object: ObjectName): Promise<void> {
    await runLine(app, commandLine(["delete", object.name], kindOf(app, object)));
}

export async function duplicate(app: App, object: ObjectName): Promise<void> {
    const ran = await runLine(app, commandLine(["copy", object.name, newName(object.name)], kindOf(app, object)));
    if (ran) {
        select(app, { kind: object.kind, name: ran.names[0] });
    }
}

/** The reason why a name is refused; empty if it is valid. */
export function refusal(app: App, from: string, to: string): string {
    const taken = app.store.state.peek().objects.find(({ name }) => name === to);
    if (to === from || to === "") {
        return "";
    }
    if (!isObjectName(to)) {
        return "A name has letters, digits, _, - and . after a letter, at most 64.";
    }
    return taken ? `A ${taken.kind} has the name ${to} already; choose another name.` : "";
}

/** Replaces the name of an object in all lines. */
export async function rename(app: App, object: ObjectName): Promise<void> {
    await editorOf(app).document.apply();
    const others = app.store.state
        .peek()
        .objects.filter(({ name, kind }) => name === object.name && kind !== object.kind)
        .map(({ kind }) => kind);
    const to = await requestName(object, others, (name) => refusal(app, object.name, name));
    if (!to || to === object.name) {
        return;
    }
    const { statements, revision } = app.store.state.peek();
    const { text, lines } = renamed(app.store.schema.peek(), textOf(statements), object.name, to);
    const creator = app.store.find(object.kind, object.name)?.statement ?? -1;
    if (!lines.has(creator)) {
        app.store.notify(`The name ${object.name} is created by a loop or a variable; change it in the text of the scene.`, "warning");
        return;
    }
    try {
        await app.engine.request("text", { text, revision, name: `rename ${object.name} to ${to}` });
        select(app, { kind: object.kind, name: to });
    } catch (error) {
        app.store.notify((error as Error).message, "error");
    }
}

export function showLine(app: App, object: ObjectName): void {
    const state = app.store.state.peek();
    const creator = app.store.find(object.kind, object.name)?.statement ?? -1;
    const line = state.statements[creator]?.line;
    if (line !== undefined) {
        editorOf(app).goTo(line);
    }
}

/** The same for the selection, for the menu and shortcuts. */
export function addObjectCommands(app: App): void {
    const commands = { hide: toggleHidden, delete: remove, rename, duplicate, "show-line": showLine };
    for (const [id, run] of Object.entries(commands)) {
        app.menuCommand(id, () => {
            const { object } = app.store.selection.peek();
            if (object) {
                void run(app, object);
            } else {
                app.store.notify("Select an object first.");
            }
        });
    }
}
