// The panel with the text of the scene.
import type { VNode } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { App } from "../../../app";
import { useValue } from "../../../use";
import { editorOf, type SceneEditor } from "./session";

const kStatus = { same: "", typed: "Typed, not applied yet", applying: "Running…", conflict: "" };

function Conflict({ editor, theirs }: { editor: SceneEditor; theirs: string }): VNode {
    return (
        <div class="scene-conflict" role="alert">
            <p>The scene was changed elsewhere in the lines that you are typing. Your text is kept here and not applied.</p>
            {theirs && <pre aria-label="The current lines of the scene">{theirs}</pre>}
            <button type="button" onClick={() => editor.document.settle("mine")}>
                Keep my text
            </button>
            <button type="button" onClick={() => editor.document.settle("theirs")}>
                Use the scene
            </button>
        </div>
    );
}

const kLocked = {
    connecting: "",
    ready: "",
    lost: "The connection is lost: the text is locked until it is back.",
    refused: "This page is no longer connected; text that was not applied can be copied from here.",
};

function Bar({ app, editor }: { app: App; editor: SceneEditor }): VNode {
    const { kind } = useValue(editor.document.status);
    const { ran, statements, error } = useValue(app.store.state);
    const connection = useValue(app.store.connection);
    const locked = connection !== "ready";
    const note = useValue(editor.document.note);
    const behind = ran < statements.length && !error;
    const status = kLocked[connection] || note || kStatus[kind] || (behind ? `Ran ${ran} of ${statements.length} lines` : "");
    return (
        <div class="scene-bar" role="toolbar" aria-label="Running the scene">
            <button
                type="button"
                disabled={locked}
                title="Run to the line of the cursor, or go back to it (Ctrl+Enter)"
                onClick={() => void editor.runTo(editor.cursorLine)}
            >
                Run to cursor
            </button>
            <button
                type="button"
                disabled={locked || (kind === "same" && !behind)}
                title="Run all lines (Ctrl+Shift+Enter)"
                onClick={() => void editor.runAll()}
            >
                Run all
            </button>
            <span class="hint" role="status">
                {status}
            </span>
        </div>
    );
}

function HelpLine({ editor }: { editor: SceneEditor }): VNode {
    const help = useValue(editor.help);
    return (
        <p class="scene-help-line hint" id="scene-help">
            {help ? (
                <>
                    <code>{help.title}</code> {help.text}
                </>
            ) : (
                "Ctrl+Space completes. Your text is run when you pause; Ctrl+Enter runs to the cursor."
            )}
        </p>
    );
}

export function ScenePanel({ app }: { app: App }): VNode {
    const editor = editorOf(app);
    const holder = useRef<HTMLDivElement>(null);
    const status = useValue(editor.document.status);
    useEffect(() => {
        holder.current?.append(editor.view.dom);
        editor.view.requestMeasure();
        return () => {
            void editor.document.apply();
            editor.view.dom.remove();
        };
    }, []);
    return (
        <div class="scene-text">
            <Bar app={app} editor={editor} />
            {status.kind === "conflict" && <Conflict editor={editor} theirs={status.theirs} />}
            <div class="scene-editor" ref={holder} />
            <HelpLine editor={editor} />
        </div>
    );
}
