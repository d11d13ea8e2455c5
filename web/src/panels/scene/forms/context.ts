// Data of the page that fields use: names of objects, files of the folder, the selection of the 3D view.
import { signal } from "@preact/signals-core";
import type { App } from "../../../app";
import type { Kind } from "../../../protocol";
import type { Values } from "../../../script/values";
import { anchored } from "../../../tools/kit/naming";
import type { FieldContext } from "./field";

const kFiles = signal<readonly string[]>([]);
let kIsRequested = false;

/** The files of the folder, requested when a field first needs them and when a form is opened. */
function files(app: App): string[] {
    if (!kIsRequested) {
        kIsRequested = true;
        app.engine.request<{ files: { name: string }[] }>("files").then(
            (reply) => {
                kFiles.value = reply.files.map(({ name }) => name);
            },
            () => undefined, // then names are typed without suggestions
        );
    }
    return [...kFiles.value];
}

export function refreshFiles(): void {
    kIsRequested = false;
}

const kFunctions = { node: "", branch: "axis", subtree: "subtree", tree: "tree", connected: "" };

/**
 * The selection of the 3D view as an expression that remains valid when the tree is recomputed; null if no nodes are selected.
 */
async function selectedNodes(app: App): Promise<string | null> {
    const { object, nodes, extent } = app.store.selection.peek();
    if (object?.kind !== "skeleton" || nodes.length === 0) {
        app.store.notify("Select nodes or branches of a skeleton in the 3D view first.");
        return null;
    }
    const text = await anchored(app, object.name, nodes);
    return kFunctions[extent] === "" ? text : `${kFunctions[extent]}(${text})`;
}

export function fieldContext(app: App, values: Values, set: FieldContext["set"]): FieldContext {
    return {
        values,
        set,
        names: (kinds: readonly Kind[]) => {
            const { objects } = app.store.state.value;
            return [...new Set(kinds.flatMap((kind) => objects.filter((object) => object.kind === kind).map(({ name }) => name)))];
        },
        files: () => files(app),
        selected: () => selectedNodes(app),
    };
}
