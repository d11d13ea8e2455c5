// A command that is being filled in: previewed while it changes and run at the end; or a statement of the document, which is
// rewritten.
import { signal } from "@preact/signals-core";
import type { App } from "../../../app";
import type { Argument, Command, Kind, ObjectName } from "../../../protocol";
import { kindsOf } from "../../../script/commands";
import { changedBy } from "../../../script/names";
import { textOf } from "../../../script/pieces";
import { type Call, lineOf, missing, type Values, withValue, wordOf } from "../../../script/values";
import { setting } from "../../../settings";
import { defaultsOf } from "../defaults";
import { refreshFiles } from "./context";
import { suggested } from "./suggest";

/** The statement that a form changes, and the object that it creates or changes. */
export interface Place {
    statement: number;
    text: string; // text of the statement when it was read
    comment: string;
    object: ObjectName;
    shows: boolean; // whether a preview of the new line after the object shows the effect of the change
}

const kSlow = new Set(["grow", "sprout", "compose", "extract", "mesh", "polygonize", "material"]);
const kEditDelay = 250; // [ms] idle time after which a statement is rewritten

/** Returns whether the command can be previewed. */
export function canShow(command: Command): boolean {
    const files = command.arguments.some(({ type }) => type.endsWith("_file"));
    const does = changedBy(command) !== undefined || command.arguments.some(({ type }) => type === "new_name");
    return does && !files && !kSlow.has(command.name);
}

/** Returns the object that a command changes. */
export function changedObject(app: App, command: Command, values: Values): ObjectName | undefined {
    const argument = changedBy(command);
    const name = argument ? wordOf(argument, values) : "";
    const givenKind = values.kind?.[0];
    const kinds = argument ? kindsOf(argument).filter((kind) => !givenKind || kind === givenKind) : [];
    const kind = kinds.find((one: Kind) => app.store.find(one, name));
    return kind && { kind, name };
}

export class Form {
    readonly command = signal<Command | null>(null);
    readonly values = signal<Values>({});
    readonly place = signal<Place | null>(null);
    readonly errorText = signal(""); // error of the engine for this line
    readonly broken = signal(""); // errors of later lines caused by the current statement
    readonly busy = signal(false);
    readonly live = setting("form.live", true); // whether lines are previewed while they change

    private open = false; // a preview is shown that is not in the document
    private again = false; // another change arrived during a request
    private timer: ReturnType<typeof setTimeout> | undefined;

    constructor(private readonly app: App) {}

    get line(): string {
        const command = this.command.value;
        return command ? lineOf(command, this.values.value, this.place.value?.comment) : "";
    }

    get missing(): Argument[] {
        const command = this.command.value;
        return command ? missing(command, this.values.value) : [];
    }

    get shows(): boolean {
        const command = this.command.value;
        return command !== null && this.live.value && canShow(command) && (this.place.value?.shows ?? true);
    }

    /** Begins a new line; null closes the form. */
    begin(command: Command | null): void {
        this.cancel();
        this.broken.value = "";
        refreshFiles();
        this.place.value = null;
        const given = command ? defaultsOf(command.name) : {};
        this.values.value = command ? { ...suggested(this.app, command, given), ...given } : {};
        this.command.value = command;
    }

    /** Begins to change a statement. */
    change({ command, values }: Call, place: Place): void {
        this.cancel();
        this.broken.value = "";
        this.place.value = place;
        this.values.value = values;
        this.command.value = command;
    }

    set(name: string, words: readonly string[], done: boolean): void {
        const argument = this.command.peek()?.arguments.find((one) => one.name === name);
        if (!argument) {
            return;
        }
        this.values.value = withValue(argument, this.values.peek(), words);
        clearTimeout(this.timer);
        if (this.missing.length > 0) {
            return;
        }
        if (this.place.peek() && (done || !this.shows)) {
            this.timer = setTimeout(() => void this.run(), done ? 0 : kEditDelay);
        } else if (this.shows) {
            this.preview();
        }
    }

    private preview(): void {
        const command = this.command.peek();
        if (!command) {
            return;
        }
        this.open = true;
        const about = this.place.peek()?.object ?? changedObject(this.app, command, this.values.peek());
        this.app.engine.preview(this.line, about).then(
            (shown) => {
                this.errorText.value = shown ? "" : this.errorText.peek();
            },
            (error: Error) => {
                this.errorText.value = error.message;
            },
        );
    }

    /** Removes the preview. */
    cancel(): void {
        clearTimeout(this.timer);
        this.errorText.value = "";
        if (this.open) {
            this.open = false;
            this.app.engine.endPreview().catch(() => undefined);
        }
    }

    /** Runs the line, or rewrites its statement. Returns whether that succeeded. */
    async run(): Promise<boolean> {
        clearTimeout(this.timer);
        const command = this.command.peek();
        if (!command || this.missing.length > 0) {
            return false;
        }
        if (this.busy.peek()) {
            this.again = true;
            return false;
        }
        this.busy.value = true;
        try {
            await (this.place.peek() ? this.rewrite() : this.append(command));
            this.errorText.value = "";
            return true;
        } catch (error) {
            this.errorText.value = (error as Error).message;
            this.revert();
            return false;
        } finally {
            this.busy.value = false;
            if (this.again) {
                this.again = false;
                void this.run();
            }
        }
    }

    private revert(): void {
        if (this.open) {
            this.open = false;
            this.app.engine.endPreview().catch(() => undefined);
        }
    }

    private async append(command: Command): Promise<void> {
        const { engine, store } = this.app;
        const { statement, message } = await engine.run(this.line, changedObject(this.app, command, this.values.peek()));
        this.open = false;
        const created = store.state.peek().objects.find((object) => object.statement === statement);
        if (created) {
            store.selection.value = { ...store.selection.peek(), object: { kind: created.kind, name: created.name }, nodes: [] };
        }
        if (message.trim() !== "") {
            store.notify(message.trim());
        }
    }

    private async rewrite(): Promise<void> {
        const place = this.place.peek();
        const { statements, revision } = this.app.store.state.peek();
        const line = this.line;
        if (!place || line === place.text) {
            this.revert();
            return;
        }
        if (statements[place.statement]?.text !== place.text) {
            throw new Error("The scene has changed in between; check the line again.");
        }
        const text = textOf(statements.map((one, i) => (i === place.statement ? { text: line } : one)));
        const before = this.app.store.state.peek().error?.message;
        this.place.value = { ...place, text: line };
        try {
            await this.app.engine.request("text", { text, revision, name: `parameters of ${place.object.name}`, joins: true });
        } catch (error) {
            this.place.value = place;
            throw error;
        }
        const { error } = this.app.store.state.peek();
        this.broken.value = error && (error.message !== before || this.broken.peek() !== "") ? `Line ${error.line}: ${error.message}` : "";
        this.revert();
    }
}
