// Notices about the document: that it was recovered from the journal.
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import type { App } from "../../app";
import { useValue } from "../../use";

async function backToSaved(app: App): Promise<void> {
    const { file, revision } = app.store.state.peek();
    const request = file === "" ? app.engine.request("text", { text: "", revision }) : app.engine.request("open", { file });
    await request.catch((error: Error) => app.store.notify(error.message, "error"));
}

export function Notices({ app }: { app: App }): VNode | null {
    const { recovered, file } = useValue(app.store.state);
    const locked = useValue(app.store.connection) !== "ready";
    const [closed, setClosed] = useState(false);
    if (!recovered || closed) {
        return null;
    }
    return (
        <aside class="notice" aria-label="Recovered scene">
            <p role="status">{`The studio was ended before ${file || "this scene"} was saved. The changes have been recovered; they are not saved yet.`}</p>
            <button type="button" class="primary" disabled={locked} onClick={() => app.command("save")}>
                Save
            </button>
            <button type="button" disabled={locked} title="Undo restores it" onClick={() => void backToSaved(app).then(() => setClosed(true))}>
                {file === "" ? "Start with an empty scene" : "Go back to the saved text"}
            </button>
            <button type="button" class="icon" aria-label="Close this notice" onClick={() => setClosed(true)}>
                ×
            </button>
        </aside>
    );
}
