// Connects the components of the page.
import { consumeAddress } from "./address";
import type { App, View } from "./app";
import { ActiveTool } from "./active_tool";
import { kShortcuts, matches, acceptsKeys } from "./keys";
import { panels } from "./panels/index";
import type { Command } from "./protocol";
import { createStore, pruneSelection, placed } from "./store";
import { tools } from "./tools/index";
import { Transport } from "./transport";
import { View3D } from "./view/view";

export interface Studio extends App {
    view: View3D & View;
    engine: Transport;
    activeTool: ActiveTool;
    firstFile: string; // with which the studio was started; empty: no file
    hasCommand(id: string): boolean; // of the page itself, by its id
    command(id: string): void;
}

function listen(studio: () => Studio): ConstructorParameters<typeof Transport>[1] {
    return {
        connection: (now) => {
            studio().store.connection.value = now;
        },
        folder: (path) => {
            studio().store.folder.value = path;
        },
        state: (state) => {
            const { store } = studio();
            store.state.value = placed(state);
            if (state.running === null) {
                store.progress.value = null;
            }
            pruneSelection(store);
        },
        progress: (statement, fraction) => {
            studio().store.progress.value = { statement, fraction };
        },
        grown: (grown) => {
            studio().store.grown.value = grown;
            studio().view.showGrown(grown.key);
        },
        geometry: (geometry) => studio().view.receive(geometry),
        follows: (about) => studio().view.follows(about),
        settled: () => studio().view.settle(),
        warned: (text) => {
            const { messages, notify } = studio().store;
            if (messages.peek().at(-1)?.text !== text) {
                // each change would repeat it
                notify(text, "warning");
            }
        },
        refused: (reason) => studio().store.notify(reason, "error"),
    };
}

function addCommands(studio: Studio): void {
    const { engine, store, view } = studio;
    const request = (type: string) => () => {
        engine.request(type).catch((error: Error) => store.notify(error.message, "error"));
    };
    studio.menuCommand("undo", request("undo"));
    studio.menuCommand("redo", request("redo"));
    studio.menuCommand("cancel", () => engine.cancel());
    studio.menuCommand("frame", () => {
        const { object } = store.selection.peek();
        view.frame(object ? [object] : undefined);
    });
    for (const side of ["front", "back", "left", "right", "top", "bottom"] as const) {
        studio.menuCommand(`look-${side}`, () => view.look(side));
    }
    studio.menuCommand("projection", () => {
        view.display.parallel.value = !view.display.parallel.peek();
    });
    studio.menuCommand("wireframe", () => {
        view.display.wireframe.value = !view.display.wireframe.peek();
    });
    studio.menuCommand("show-all", () => {
        store.hidden.value = new Set();
    });
}

function listenToKeys(studio: Studio): void {
    addEventListener("keydown", (event) => {
        if (event.defaultPrevented || !event.key) {
            // browsers that fill in forms send events without a key
            return;
        }
        if (document.querySelector("dialog[open]")) {
            // the page behind a dialog receives no keys, even if it has the focus
            return;
        }
        const shortcut = kShortcuts.find((one) => one.keys.some((keys) => matches(keys, event)));
        if (acceptsKeys(event.target)) {
            if (shortcut?.always) {
                event.preventDefault();
                studio.command(shortcut.id);
            }
            return;
        }
        if (studio.activeTool.key(event)) {
            event.preventDefault();
            return;
        }
        const tool = studio.tools.find((one) => one.shortcut && matches(one.shortcut, event));
        if (tool && (!tool.enabled || tool.enabled(studio))) {
            event.preventDefault();
            studio.take(tool.id);
            return;
        }
        if (event.target === studio.view.element() && studio.view.key(event)) {
            event.preventDefault();
            return;
        }
        if (shortcut) {
            event.preventDefault();
            studio.command(shortcut.id);
        }
    });
}

/** Connects to the server of the page. */
export function createStudio(): Studio {
    const store = createStore();
    const commands = new Map<string, () => void>();
    const { token, firstFile } = consumeAddress(location, history, sessionStorage);
    const engine = new Transport(
        { origin: location.origin, token },
        listen(() => studio),
    );
    const view = new View3D(store, engine);
    const activeTool = new ActiveTool(() => studio);
    const studio: Studio = {
        engine,
        store,
        view,
        tools,
        panels,
        activeTool,
        firstFile,
        take: (tool) => activeTool.take(tool),
        menuCommand: (id, run) => void commands.set(id, run),
        hasCommand: (id) => commands.has(id),
        command: (id) => commands.get(id)?.(),
    };
    view.listenTo(activeTool);
    addCommands(studio);
    listenToKeys(studio);
    engine.connect();
    engine
        .request<{ schema: Command[] }>("schema")
        .then((reply) => {
            store.schema.value = reply.schema;
        })
        .catch((error: Error) => store.notify(error.message, "error"));
    activeTool.take("select");
    return studio;
}
