// The editor of the text of the scene, synchronized with the selection and the run state.
import { acceptCompletion, autocompletion, closeCompletion, completionKeymap, completionStatus, selectedCompletion } from "@codemirror/autocomplete";
import { history, redo, redoDepth, undo, undoDepth } from "@codemirror/commands";
import { Annotation, Compartment, EditorSelection, EditorState, type Extension, Transaction } from "@codemirror/state";
import { EditorView, highlightActiveLine, highlightActiveLineGutter, highlightSpecialChars, keymap, lineNumbers, type ViewUpdate } from "@codemirror/view";
import { effect, signal } from "@preact/signals-core";
import type { App } from "../../../app";
import type { ObjectName } from "../../../protocol";
import { placesIn } from "../../../script/names";
import { pieceAt, piecesOf } from "../../../script/pieces";
import { unfinished } from "../../../script/unfinished";
import { scrollWithin } from "../../../scroll";
import { Applying } from "./applying";
import { completions } from "./complete";
import { type Help, helpAt, helpOnHover } from "./help";
import { colors } from "./highlight";
import { kEditorKeys } from "./keys";
import { markLines, marksOf, setMarks } from "./marks";
import { changesBetween } from "./sync";
import { look } from "./theme";

const kMargin = 24; // [px] above and below a line that is shown
const kByProgram = Annotation.define<boolean>(); // of changes by the program

/** Accepts a completion; if the text already equals it, Enter inserts a new line. */
function acceptOther(view: EditorView): boolean {
    const { head } = view.state.selection.main;
    const label = selectedCompletion(view.state)?.label ?? "";
    const isThere = view.state.sliceDoc(Math.max(head - label.length, 0), head) === label;
    return isThere ? closeCompletion(view) && false : acceptCompletion(view);
}

export class SceneEditor {
    readonly view: EditorView;
    readonly document: Applying;
    readonly help = signal<Help | null>(null);

    private readonly locked = new Compartment();
    private readonly past = new Compartment();
    private choosing = false; // the cursor selected the object, so that no scrolling is needed
    private shown: ObjectName | null = null;

    constructor(private readonly app: App) {
        this.document = new Applying(app, {
            text: () => this.text,
            write: (text) => this.write(text),
            isHalfTyped: () => this.isHalfTyped(),
            changed: () => this.changed(),
        });
        this.view = new EditorView({ state: EditorState.create({ extensions: this.extensions() }) });
        const { store } = app;
        effect(() => this.document.receive(store.state.value));
        effect(() => {
            void store.schema.value;
            void store.progress.value;
            this.mark(store.selection.value.object);
        });
        effect(() => this.showSelected(store.selection.value.object));
        effect(() => {
            const lost = store.connection.value !== "ready";
            this.view.dispatch({ effects: this.locked.reconfigure(EditorState.readOnly.of(lost)) });
            if (!lost) {
                this.document.soon();
            }
        });
        addEventListener("beforeunload", (event) => {
            if (this.document.isTyped) {
                event.preventDefault();
            }
        });
    }

    private extensions(): Extension[] {
        const schema = () => this.app.store.schema.peek();
        const run = (command: () => unknown) => () => {
            command();
            return true;
        };
        return [
            keymap.of([
                { key: "Mod-Enter", run: run(() => this.runTo(this.cursorLine)) },
                { key: "Mod-Shift-Enter", run: run(() => this.runAll()) },
                { key: "Mod-z", run: run(() => this.back()) },
                { key: "Mod-y", mac: "Mod-Shift-z", run: run(() => this.forth()) },
                { key: "Ctrl-Shift-z", run: run(() => this.forth()) },
                { key: "Mod-s", run: run(() => this.document.apply().then(() => this.app.command("save"))) },
            ]),
            markLines((line) => void this.runTo(line)),
            lineNumbers(),
            highlightActiveLine(),
            highlightActiveLineGutter(),
            highlightSpecialChars(),
            this.past.of(history()),
            this.locked.of(EditorState.readOnly.of(true)),
            colors(schema),
            helpOnHover(schema),
            autocompletion({ override: [completions(this.app, (line) => this.statementsAbove(line))], icons: false, defaultKeymap: false }),
            keymap.of([{ key: "Enter", run: acceptOther }, ...completionKeymap.filter(({ key }) => key !== "Enter"), ...kEditorKeys]),
            EditorView.contentAttributes.of({ tabindex: "0", "aria-label": "Text of the scene", "aria-describedby": "scene-help" }),
            EditorView.updateListener.of((update) => this.updated(update)),
            EditorView.domEventHandlers({ blur: () => this.blurred() }),
            look(),
        ];
    }

    private get text(): string {
        return this.view.state.doc.toString();
    }

    get cursorLine(): number {
        return this.view.state.doc.lineAt(this.view.state.selection.main.head).number;
    }

    private statementsAbove(line: number): number {
        return Math.max(pieceAt(piecesOf(this.text), line), 0);
    }

    // Actions of the user.

    private updated(update: ViewUpdate): void {
        const byProgram = update.transactions.some((transaction) => transaction.annotation(kByProgram));
        if (update.docChanged && !byProgram) {
            this.document.typed();
        }
        if (update.selectionSet || update.docChanged) {
            this.help.value = this.helpHere();
            const moved = update.startState.doc.lineAt(update.startState.selection.main.head).number !== this.cursorLine;
            if (!byProgram && !update.docChanged && moved) {
                this.choose();
                this.document.soon();
            }
        }
    }

    private helpHere(): Help | null {
        const { head } = this.view.state.selection.main;
        const line = this.view.state.doc.lineAt(head);
        return helpAt(this.app.store.schema.peek(), line.text, head - line.from);
    }

    // Whether keys are received here, or were before the window lost its focus: then the user may return to an incomplete line.
    private get isWrittenIn(): boolean {
        return document.activeElement === this.view.contentDOM;
    }

    private blurred(): void {
        if (!this.isWrittenIn) {
            void this.document.apply();
        }
    }

    private isHalfTyped(): boolean {
        if (!this.isWrittenIn) {
            return false;
        }
        const pieces = piecesOf(this.text);
        const line = this.view.state.doc.line(this.cursorLine);
        return pieces.at(-1)?.open === true || this.isOffered() || unfinished(this.app.store.schema.peek(), line.text);
    }

    // Whether the word at the cursor is incomplete: a completion is offered, and no object has this name.
    private isOffered(): boolean {
        const { head } = this.view.state.selection.main;
        const word = /[\w.-]*$/.exec(this.view.state.sliceDoc(this.view.state.doc.lineAt(head).from, head))?.[0];
        const isName = this.app.store.state.peek().objects.some(({ name }) => name === word);
        return !isName && completionStatus(this.view.state) === "active";
    }

    // When the document has the typed text, its own undo is used.
    private back(): void {
        if (this.document.isTyped && undoDepth(this.view.state) > 0) {
            undo(this.view);
        } else {
            this.app.command("undo");
        }
    }

    private forth(): void {
        if (redoDepth(this.view.state) > 0) {
            redo(this.view);
        } else {
            this.app.command("redo");
        }
    }

    // Selects the object that the line under the cursor created.
    private choose(): void {
        const { selection, state, schema } = this.app.store;
        const { statements, objects } = state.peek();
        const number = this.document.isTyped ? -1 : pieceAt(statements, this.cursorLine);
        const text = statements[number]?.text ?? "";
        const named = text.trim() === "" ? [] : placesIn(schema.peek(), text).filter(({ role }) => role !== "uses");
        const found =
            objects.find(({ statement }) => statement === number && text.trim() !== "") ??
            named.flatMap(({ name, kinds }) => objects.filter((one) => one.name === name && (kinds.length === 0 || kinds.includes(one.kind))))[0];
        const { object, extent } = selection.peek();
        if (found && (found.kind !== object?.kind || found.name !== object.name)) {
            this.choosing = true;
            selection.value = { object: { kind: found.kind, name: found.name }, nodes: [], extent };
            this.choosing = false;
        }
    }

    // Events of the document.

    private changed(): void {
        if (!this.document.isTyped && undoDepth(this.view.state) + redoDepth(this.view.state) > 0) {
            this.view.dispatch({ effects: this.past.reconfigure([]) });
            this.view.dispatch({ effects: this.past.reconfigure(history()) });
        }
        this.mark(this.app.store.selection.peek().object);
    }

    private write(text: string): void {
        const changes = changesBetween(this.text, text);
        if (changes.length > 0) {
            this.view.dispatch({ changes, annotations: [kByProgram.of(true), Transaction.addToHistory.of(false)] });
        }
    }

    private mark(selected: ObjectName | null): void {
        const { store } = this.app;
        const { isTyped, sent } = this.document;
        if (isTyped && sent === null) {
            return; // the marks move with the text until the document has it
        }
        const state = store.state.peek();
        const statements = isTyped ? piecesOf(this.text).map(({ text, line }) => ({ text, line, message: "" })) : state.statements;
        const marks = marksOf({ ...state, statements }, store.schema.peek(), store.progress.peek(), selected);
        this.view.dispatch({ effects: setMarks(marks), annotations: kByProgram.of(true) });
    }

    private showSelected(object: ObjectName | null): void {
        const same = object?.kind === this.shown?.kind && object?.name === this.shown?.name;
        this.shown = object;
        const creator = object && this.app.store.find(object.kind, object.name)?.statement;
        const line = typeof creator === "number" ? this.app.store.state.peek().statements[creator]?.line : undefined;
        if (!same && !this.choosing && line !== undefined && !this.document.isTyped) {
            this.show(line, false);
        }
    }

    private show(line: number, focus: boolean): void {
        const { from } = this.view.state.doc.line(Math.min(line, this.view.state.doc.lines));
        this.view.dispatch({
            selection: this.view.hasFocus && !focus ? undefined : EditorSelection.cursor(from),
            annotations: kByProgram.of(true),
        });
        const { top, bottom } = this.view.lineBlockAt(from);
        scrollWithin(this.view.scrollDOM, top - kMargin, bottom + kMargin);
    }

    /** Moves to a line of the text for editing. */
    goTo(line: number): void {
        document.getElementById("tab-scene")?.click();
        requestAnimationFrame(() => {
            this.show(line, true);
            this.view.focus();
        });
    }

    // Requests to the engine.

    /** Runs to a line, or goes back to the state after it. */
    async runTo(line: number): Promise<void> {
        closeCompletion(this.view);
        const count = pieceAt(piecesOf(this.text), line) + 1;
        await this.document.apply(count);
        const { ran, statements, error } = this.app.store.state.peek();
        const failed = error !== null && error.statement < count;
        if (!this.document.isTyped && ran !== Math.min(count, statements.length) && !failed) {
            await this.ran(count);
        }
    }

    async runAll(): Promise<void> {
        closeCompletion(this.view);
        await this.document.apply();
        const { ran, statements } = this.app.store.state.peek();
        if (!this.document.isTyped && ran < statements.length) {
            await this.ran(statements.length);
        }
    }

    private async ran(count: number): Promise<void> {
        await this.app.engine.request("ran", { count }).catch((error: Error) => this.app.store.notify(error.message, "error"));
    }
}

const kEditors = new WeakMap<App, SceneEditor>();

/** The editor of a page; there is one, visible or not. */
export function editorOf(app: App): SceneEditor {
    const known = kEditors.get(app) ?? new SceneEditor(app);
    kEditors.set(app, known);
    return known;
}
