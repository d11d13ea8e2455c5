// A command that is prepared, previewed while its sliders move, and run; or a statement of the document that is changed in the
// same way.
import { type Signal, signal } from "@preact/signals-core";
import { type App, EngineError } from "../../app";
import type { Argument, Command, ObjectName, SceneObject, State } from "../../protocol";
import { kindsOf } from "../../script/commands";
import { lineOf, missing, readCall, type Values, withValue, wordOf } from "../../script/values";
import { rewriteStatement } from "../../tools/kit/source";
import { keyOf } from "../../view/object_view";
import { defaultsOf } from "../scene/defaults";
import { commandNamed } from "./values";

/** The statement that a card changes. */
export interface Bound {
    statement: number;
    text: string; // text of the statement when it was read
    comment: string;
}

export interface ObjectStatement {
    command: Command;
    values: Values;
    bound: Bound;
}

/** The object that a command creates or changes: its new name, or its first object argument. */
export function targetOf(command: Command, values: Values): ObjectName | null {
    const named = command.arguments.find(({ type }) => type === "new_name");
    const first = command.arguments.find(({ type, positional }) => type === "object" && positional);
    const argument = named ?? first;
    const name = argument ? wordOf(argument, values) : "";
    const kind = kKinds[command.name] ?? (first && kindsOf(first)[0]);
    return name && kind ? { kind, name } : null;
}

const kKinds: Record<string, ObjectName["kind"]> = {
    "pointset generate": "points",
    "pointset near": "points",
    grow: "skeleton",
    sprout: "skeleton",
    extract: "skeleton",
    compose: "skeleton",
    mesh: "mesh",
    loadmesh: "mesh",
    "pointset load": "points",
};

/** The newest statement that created an object by one of the commands; later ones may have changed it. */
export function creatorOf(state: State, schema: readonly Command[], object: SceneObject, names: readonly string[]): ObjectStatement | null {
    const commands = schema.filter(({ name }) => names.includes(name));
    const begins = commands.flatMap(({ name, aliases }) => [name, ...aliases].map((words) => words.split(" ")[0]));
    for (let i = Math.min(object.statement, state.statements.length - 1); i >= 0; --i) {
        const { text } = state.statements[i];
        const call = begins.some((word) => text.trimStart().startsWith(word)) ? readCall(commands, text) : null;
        const target = call && targetOf(call.command, call.values);
        if (call && target?.kind === object.kind && target.name === object.name) {
            return { command: call.command, values: call.values, bound: { statement: i, text, comment: call.comment } };
        }
    }
    return null;
}

export interface CardOptions {
    commands: readonly string[]; // commands that it can prepare; the first is the initial one
    /** Initial values, from the objects, the selection and the existing values. */
    suggest(app: App, command: string, given: Values): Values;
    /** Whether its lines are previewed before they are run. */
    shows: boolean;
    /** Lines that are run after a new line: radii and smoothing of a tree. */
    also?(command: Command, values: Values): string[];
    /** Custom execution of a text; throws if it is refused. */
    perform?(text: string, bound: Bound | null, target: ObjectName | null): Promise<void>;
    ran?(target: ObjectName | null): void;
    /** The user stopped the command. Only defined for commands that can be stopped. */
    stopped?(): void;
}

/** Shows or hides an object. */
export function setShown(app: App, object: ObjectName, shown: boolean): void {
    const { hidden } = app.store;
    const key = keyOf(object);
    if (hidden.peek().has(key) === shown) {
        const kept = [...hidden.peek()].filter((one) => one !== key);
        hidden.value = new Set(shown ? kept : [...kept, key]);
    }
}

/** Returns whether the user stopped the command. */
export function isCancelled(error: unknown): boolean {
    return error instanceof EngineError && error.kind === "cancelled";
}

/** Runs lines, or rewrites the statement. */
export async function performText(app: App, text: string, bound: Bound | null, target: ObjectName | null, about?: ObjectName): Promise<void> {
    if (bound) {
        await rewriteStatement(app, bound.statement, text, `parameters of ${target?.name ?? "it"}`);
        await app.engine.endPreview();
    } else {
        const { message } = await app.engine.run(text, about);
        if (message) {
            app.store.notify(message.trim());
        }
    }
}

export class Card {
    readonly command: Signal<string>;
    readonly values = signal<Values>({});
    readonly bound = signal<Bound | null>(null);
    readonly errorText = signal(""); // error of the engine for it
    readonly shown = signal(0); // number of received previews; 0: the document is shown
    readonly busy = signal(false);
    private given: Values = {}; // by the user, kept when suggestions change
    private open = false; // a preview is shown that is not in the document
    private wanted = ""; // line of the newest change of the bound statement

    constructor(
        readonly app: App,
        readonly options: CardOptions,
    ) {
        this.command = signal(options.commands[0]);
    }

    /** Null until the schema has been loaded. */
    get schema(): Command | null {
        return commandNamed(this.app.store.schema.value, this.command.value) ?? null;
    }

    get arguments(): Argument[] {
        return this.schema?.arguments ?? [];
    }

    get line(): string {
        const command = this.schema;
        return command ? lineOf(command, this.values.value, this.bound.value?.comment) : "";
    }

    get target(): ObjectName | null {
        const command = this.schema;
        return command ? targetOf(command, this.values.value) : null;
    }

    private get makesNew(): boolean {
        return this.arguments.some(({ type }) => type === "new_name");
    }

    /** The object that the line changes, which must exist before it. New objects are appended. */
    get about(): ObjectName | undefined {
        return this.makesNew ? undefined : (this.target ?? undefined);
    }

    /** Help of the missing argument; empty if the line is complete. */
    get missing(): string {
        const command = this.schema;
        return command ? (missing(command, this.values.value)[0]?.help ?? "") : "its command";
    }

    choose(command: string): void {
        this.endPreview();
        this.command.value = command;
        this.given = {};
        this.renew();
    }

    /** Creates a new line for the selection. Values of the user are kept. */
    renew(): void {
        this.bound.value = null;
        this.errorText.value = "";
        const command = this.command.peek();
        this.values.value = { ...this.options.suggest(this.app, command, this.given), ...defaultsOf(command), ...this.given };
    }

    /** Begins to change a statement of the document. */
    bind({ command, values, bound }: ObjectStatement): void {
        this.command.value = command.name;
        this.values.value = values;
        this.bound.value = bound;
        this.errorText.value = "";
        this.given = {};
    }

    /** The central value of a slider. */
    usual(name: string): number | undefined {
        return Number(this.options.suggest(this.app, this.command.peek(), this.values.peek())[name]?.[0]) || undefined;
    }

    /** Updates the card to the state of the document. */
    follow(state: State): void {
        const bound = this.bound.peek();
        if (this.busy.peek()) {
            return;
        }
        if (!bound) {
            this.renew();
        } else if (state.statements[bound.statement]?.text !== bound.text) {
            this.reread();
        }
    }

    /** Discards changes that are not in the document. */
    reread(): void {
        this.endPreview();
        if (!this.bound.peek()) {
            return;
        }
        const target = this.target;
        const object = target && this.app.store.find(target.kind, target.name);
        const creator = object && creatorOf(this.app.store.state.peek(), this.app.store.schema.peek(), object, this.options.commands);
        if (creator) {
            this.bind(creator);
        } else {
            this.given = {};
            this.renew();
        }
    }

    set(name: string, words: readonly string[], done: boolean): void {
        const argument = this.arguments.find((one) => one.name === name);
        if (!argument) {
            return;
        }
        this.given = { ...this.given, [name]: words };
        if (argument.type === "object" && !this.bound.peek()) {
            this.renew(); // the suggestions depend on the object
        } else {
            this.values.value = withValue(argument, this.values.peek(), words);
        }
        if (done && this.bound.peek()) {
            void this.run();
        } else if (!this.missing) {
            this.preview();
        }
    }

    /** Runs a new line, even if a statement was being changed. */
    runNew(): Promise<boolean> {
        if (this.bound.peek()) {
            this.renew();
        }
        return this.run();
    }

    /** A new line that begins with a value. */
    begin(name: string, word: string): void {
        this.given = { [name]: [word] };
        this.renew();
    }

    /** Sets a value without a preview. */
    take(name: string, word: string): void {
        this.values.value = { ...this.values.peek(), [name]: [word] };
    }

    /** Runs the line, or replaces the bound statement. Returns whether that succeeded. */
    async run(): Promise<boolean> {
        const command = this.schema;
        const bound = this.bound.peek();
        if (!command || this.missing || (bound && bound.text.trim() === this.line)) {
            this.endPreview();
            return false;
        }
        const line = this.line;
        this.wanted = line;
        if (this.busy.peek()) {
            if (this.options.stopped) {
                this.app.engine.cancel(); // long previews are cancelled
            }
            return false; // the pending request continues with the newest line
        }
        this.busy.value = true;
        const target = this.target;
        try {
            const text = [line, ...(bound ? [] : (this.options.also?.(command, this.values.peek()) ?? []))].join("\n");
            await (this.options.perform?.(text, bound, target) ?? performText(this.app, text, bound, target, this.about));
            this.closed();
            this.errorText.value = "";
            this.rebind(line);
            this.options.ran?.(target);
        } catch (error) {
            if (!isCancelled(error) || this.wanted === line) {
                this.failed(error as Error);
                return false;
            }
        } finally {
            this.busy.value = false;
        }
        return this.bound.peek() && this.wanted !== line ? this.run() : true;
    }

    endPreview(): void {
        if (this.open) {
            this.closed();
            this.app.engine.endPreview().catch(() => undefined);
        }
    }

    private closed(): void {
        this.open = false;
        this.shown.value = 0;
    }

    private preview(): void {
        const isDone = this.bound.peek() !== null && !this.makesNew; // a preview would repeat the change
        if (!this.options.shows || isDone) {
            return;
        }
        this.open = true;
        if (this.target) {
            setShown(this.app, this.target, true);
        }
        this.app.engine.preview(this.line, this.about).then(
            (shown) => {
                if (shown) {
                    this.errorText.value = "";
                    ++this.shown.value;
                }
            },
            (error: Error) => {
                this.errorText.value = error.message;
            },
        );
    }

    // Finds the new position of the line, so that the next change is applied there.
    private rebind(line: string): void {
        const { statements } = this.app.store.state.peek();
        const before = this.bound.peek();
        const isThere = before && statements[before.statement]?.text.trim() === line;
        const at = isThere ? before.statement : statements.findLastIndex(({ text }) => text.trim() === line);
        this.bound.value = at >= 0 ? { statement: at, text: statements[at].text, comment: before?.comment ?? "" } : null;
    }

    private failed(error: Error): void {
        this.endPreview();
        if (isCancelled(error)) {
            this.options.stopped?.();
        } else {
            this.errorText.value = error.message;
        }
    }
}
