// Typed text becomes the text of the document when the user pauses and the line is complete. Changes of the document by others
// are merged, and typed text is never lost.
import { signal } from "@preact/signals-core";
import type { App } from "../../../app";
import type { State } from "../../../protocol";
import { difference } from "../../../script/merge";
import { piecesOf, textOf } from "../../../script/pieces";
import { storeDraft, storedDraft } from "./draft";
import { normal, Sync } from "./sync";

export interface Status {
    kind: "same" | "typed" | "applying" | "conflict";
    theirs: string; // current lines of the document in a conflict
}

/** The editor in which the text is typed. */
export interface TextEditor {
    text(): string;
    write(text: string): void; // replaces its text by the text of the document
    isHalfTyped(): boolean; // then errors are not reported yet
    changed(): void; // the state of the document or of the request has changed
}

const kRest = 1000; // [ms] idle time after which typed text is applied
const kNote = 6000; // [ms]

export class Applying {
    readonly status = signal<Status>({ kind: "same", theirs: "" });
    readonly note = signal(""); // external change of the document

    private readonly sync = new Sync();
    private timer: ReturnType<typeof setTimeout> | undefined;
    private noteTimer: ReturnType<typeof setTimeout> | undefined;
    private known = false; // whether a document has been received
    private recalled = false; // the typed text was restored, and waits for the user

    constructor(
        private readonly app: App,
        private readonly editor: TextEditor,
    ) {}

    /** Whether there is typed text that the document does not have. */
    get isTyped(): boolean {
        return this.sync.isTyped(this.editor.text());
    }

    /** The text of the pending request. */
    get sent(): string | null {
        return this.sync.sent;
    }

    /** Receives the current document. */
    receive(state: State): void {
        if (!this.known && state.revision > 0) {
            this.recall();
        }
        const before = this.sync.base;
        this.editor.write(this.sync.receive(textOf(state.statements), this.editor.text()));
        const changed = this.sync.base !== before || this.sync.theirs !== null;
        if (changed && this.known && state.by !== "" && state.by !== this.app.engine.client) {
            this.notify("The scene was changed in another tab.");
        }
        this.known = state.revision > 0;
        if (!this.isTyped) {
            clearTimeout(this.timer);
        } else if (changed) {
            this.soon();
        }
        this.updateStatus();
        this.editor.changed();
    }

    // Text typed before the page was reloaded; the document may have changed since.
    private recall(): void {
        const draft = storedDraft(this.app.store.folder.peek());
        if (draft) {
            this.sync.begin(draft.base);
            this.editor.write(draft.text);
            this.recalled = true;
        }
    }

    /** Text was typed, or the cursor moved. */
    typed(): void {
        this.recalled = false;
        this.updateStatus();
        this.soon();
    }

    soon(): void {
        clearTimeout(this.timer);
        if (!this.isTyped || this.recalled) {
            return;
        }
        this.timer = setTimeout(() => {
            if (!this.editor.isHalfTyped()) {
                void this.apply();
            }
        }, kRest);
    }

    /** Makes the typed text the text of the document, and runs `count` statements, or as many as possible. */
    async apply(count?: number): Promise<void> {
        clearTimeout(this.timer);
        const text = normal(this.editor.text());
        const { store, engine } = this.app;
        if (!this.sync.isTyped(text) || this.sync.theirs !== null || store.connection.peek() !== "ready") {
            return;
        }
        this.recalled = false;
        if (this.sync.sent !== null) {
            this.hurry(text);
            return;
        }
        const { revision } = store.state.peek();
        this.sync.sent = text;
        this.updateStatus();
        let again = false;
        try {
            await engine.request("text", { text, revision, count, name: this.nameOf(text), joins: true });
        } catch (error) {
            again = store.state.peek().revision !== revision; // then the new state has been merged
            if (!again && normal(this.editor.text()) === text) {
                store.notify((error as Error).message, "error");
            }
        }
        this.sync.sent = null;
        this.updateStatus();
        this.editor.changed();
        if (again || normal(this.editor.text()) !== text) {
            this.soon();
        }
    }

    // A newer text waits for the running one, unless it changes it or a previous statement.
    private hurry(text: string): void {
        const { running } = this.app.store.state.peek();
        const sent = this.sync.sent ?? "";
        const [first] = difference(sent.split("\n"), text.split("\n"));
        const piece = running === null ? undefined : piecesOf(sent)[running];
        if (first && piece && first.from + 1 < piece.line + piece.text.split("\n").length) {
            this.app.engine.cancel();
        }
    }

    // The name of the change for undo; consecutive changes of one line are joined.
    private nameOf(text: string): string {
        const [first] = difference(this.sync.base.split("\n"), text.split("\n"));
        return `change in line ${(first?.from ?? 0) + 1}`;
    }

    /** Ends a conflict: if both changed the same lines, one version is kept. */
    settle(prefer: "mine" | "theirs"): void {
        this.editor.write(this.sync.settle(this.editor.text(), prefer));
        this.updateStatus();
        this.editor.changed();
        void this.apply();
    }

    private keep(): void {
        if (this.known) {
            const draft = this.isTyped ? { base: this.sync.base, text: this.editor.text() } : null;
            storeDraft(this.app.store.folder.peek(), draft);
        }
    }

    private notify(text: string): void {
        this.note.value = text;
        clearTimeout(this.noteTimer);
        this.noteTimer = setTimeout(() => {
            this.note.value = "";
        }, kNote);
    }

    private updateStatus(): void {
        this.keep();
        const { theirs, base, sent } = this.sync;
        const kind = theirs !== null ? "conflict" : sent !== null ? "applying" : this.isTyped ? "typed" : "same";
        const lines = theirs === null ? [] : difference(base.split("\n"), theirs.split("\n")).flatMap((hunk) => hunk.lines);
        const now: Status = { kind, theirs: lines.join("\n") };
        const { kind: before, theirs: shown } = this.status.peek();
        if (now.kind !== before || now.theirs !== shown) {
            this.status.value = now;
        }
    }
}
