// Menu bar, undo and redo, the name of the document, state of the connection.
import type { VNode } from "preact";
import { FileWork } from "../panels/files/work";
import { MenuBar } from "../panels/menu/bar";
import type { Studio } from "../studio";
import { useValue } from "../use";

const kConnection = {
    connecting: "Connecting…",
    ready: "",
    lost: "Connection lost; trying again. Edits wait until it is back.",
    refused: "No longer connected",
};

function UndoButtons({ studio }: { studio: Studio }): VNode {
    const state = useValue(studio.store.state);
    const locked = useValue(studio.store.connection) !== "ready";
    const last = state.undo.at(-1);
    const next = state.redo.at(-1);
    return (
        <div class="group" role="group" aria-label="History">
            <button
                type="button"
                class="icon"
                disabled={!last || locked}
                aria-label="Undo"
                title={last ? `Undo: ${last} (Ctrl+Z)` : "Nothing to undo"}
                onClick={() => studio.command("undo")}
            >
                ↶
            </button>
            <button
                type="button"
                class="icon"
                disabled={!next || locked}
                aria-label="Redo"
                title={next ? `Redo: ${next} (Ctrl+Shift+Z)` : "Nothing to redo"}
                onClick={() => studio.command("redo")}
            >
                ↷
            </button>
        </div>
    );
}

function DocumentName({ studio }: { studio: Studio }): VNode {
    const { file, saved } = useValue(studio.store.state);
    return (
        <span class="document">
            {file || "Untitled scene"}
            {!saved && <span class="unsaved"> (not saved)</span>}
        </span>
    );
}

export function Header({ studio }: { studio: Studio }): VNode {
    const connection = useValue(studio.store.connection);
    return (
        <header class="header">
            <h1 class="brand">Coppice</h1>
            <MenuBar studio={studio} />
            <UndoButtons studio={studio} />
            <DocumentName studio={studio} />
            <span class="connection" role="status" data-connection={connection}>
                {kConnection[connection]}
            </span>
            <button type="button" class="icon" aria-label="Keyboard shortcuts" title="Keyboard shortcuts (?)" onClick={() => studio.command("shortcuts")}>
                ?
            </button>
            <FileWork studio={studio} />
        </header>
    );
}
