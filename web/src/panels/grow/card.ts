// A command that is made ready, shown while its sliders move, and run; or a statement of the document that is changed in the same way.
import { type Signal, signal } from "@preact/signals-core";
import { type App, EngineError } from "../../app";
import type { Argument, Command, ObjectName, SceneObject, State } from "../../protocol";
import { kindsOf } from "../../script/commands";
import { lineOf, missing, readCall, type Values, withValue, wordOf } from "../../script/values";
import { rewriteStatement } from "../../tools/kit/source";
import { keyOf } from "../../view/shown";
import { defaultsOf } from "../scene/defaults";
import { commandNamed } from "./values";

/** The statement that a card changes. */
export interface Bound {
    statement: number;
    text: string; // as it stood when it was read
    comment: string;
}

export interface Made {
    command: Command;
    values: Values;
    bound: Bound;
}

/** What a command makes or changes: its new name, or the object that it is told first. */
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

/** The newest statement that made an object by one of the commands; later ones may have changed it. */
export function makerOf(state: State, schema: readonly Command[], object: SceneObject, names: readonly string[]): Made | null {
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
    commands: readonly string[]; // that it can make ready; the first at the beginning
    /** Values to begin with, by what there is and is selected, and what was given already. */
    suggest(app: App, command: string, given: Values): Values;
    /** Whether its lines are shown before they are run. */
    shows: boolean;
    /** What is run behind a new line: radii and smoothing of a tree. */
    also?(command: Command, values: Values): string[];
    /** Runs a text in a way of its own; throws where it is refused. */
    perform?(text: string, bound: Bound | null, target: ObjectName | null): Promise<void>;
    ran?(target: ObjectName | null): void;
    /** The user stopped it. Only what can be stopped has this. */
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

/** Whether the user stopped it. */
export function isCancelled(error: unknown): boolean {
    return error instanceof EngineError && error.kind === "cancelled";
}

/** Runs lines at the end, or writes the statement anew. */
export async function performText(app: App, text: string, bound: Bound | null, target: ObjectName | null, about?: ObjectName): Promise<void> {
    if (bound) {
        await rewriteStatement(app, bound.statement, text, `parameters of ${target?.name ?? "it"}`);
        await app.engine.endPreview();
    } else {
        const { says } = await app.engine.run(text, about);
        if (says) {
            app.store.say(says.trim());
        }
    }
}

export class Card {
    readonly command: Signal<string>;
    readonly values = signal<Values>({});
    readonly bound = signal<Bound | null>(null);
    readonly trouble = signal(""); // what the engine says against it
    readonly shown = signal(0); // previews that came; 0: what is seen is that of the document
    readonly busy = signal(false);
    private given: Values = {}; // by the user, kept when suggestions change
    private open = false; // something is shown that is not in the document
    private wanted = ""; // line of the newest change of the bound statement

    constructor(
        readonly app: App,
        readonly options: CardOptions,
    ) {
        this.command = signal(options.commands[0]);
    }

    /** Null until the schema is known. */
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

    /** What has to be there before the line: what it changes. New things come at the end. */
    get about(): ObjectName | undefined {
        return this.makesNew ? undefined : (this.target ?? undefined);
    }

    /** Why the line is not whole yet; empty where it is. */
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

    /** A new line, by what is selected. What the user gave stays. */
    renew(): void {
        this.bound.value = null;
        this.trouble.value = "";
        const command = this.command.peek();
        this.values.value = { ...this.options.suggest(this.app, command, this.given), ...defaultsOf(command), ...this.given };
    }

    /** From now on a statement of the document is changed. */
    bind({ command, values, bound }: Made): void {
        this.command.value = command.name;
        this.values.value = values;
        this.bound.value = bound;
        this.trouble.value = "";
        this.given = {};
    }

    /** The value about which a slider goes. */
    usual(name: string): number | undefined {
        return Number(this.options.suggest(this.app, this.command.peek(), this.values.peek())[name]?.[0]) || undefined;
    }

    /** Brings the card to what the document has now. */
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

    /** What was changed here and not in the document is forgotten. */
    reread(): void {
        this.endPreview();
        if (!this.bound.peek()) {
            return;
        }
        const target = this.target;
        const object = target && this.app.store.find(target.kind, target.name);
        const made = object && makerOf(this.app.store.state.peek(), this.app.store.schema.peek(), object, this.options.commands);
        if (made) {
            this.bind(made);
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
            this.renew(); // what suits depends on what it is about
        } else {
            this.values.value = withValue(argument, this.values.peek(), words);
        }
        if (done && this.bound.peek()) {
            void this.run();
        } else if (!this.missing) {
            this.preview();
        }
    }

    /** Runs a line of its own, also where a statement was being changed. */
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

    /** Gives a value without showing what it does. */
    take(name: string, word: string): void {
        this.values.value = { ...this.values.peek(), [name]: [word] };
    }

    /** Runs the line, or puts it in place of the bound statement. Tells whether that was done. */
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
                this.app.engine.cancel(); // what takes long is not waited for
            }
            return false; // the one under way goes on with the newest line
        }
        this.busy.value = true;
        const target = this.target;
        try {
            const text = [line, ...(bound ? [] : (this.options.also?.(command, this.values.peek()) ?? []))].join("\n");
            await (this.options.perform?.(text, bound, target) ?? performText(this.app, text, bound, target, this.about));
            this.closed();
            this.trouble.value = "";
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
        const isDone = this.bound.peek() !== null && !this.makesNew; // shown again it would be done twice
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
                    this.trouble.value = "";
                    ++this.shown.value;
                }
            },
            (error: Error) => {
                this.trouble.value = error.message;
            },
        );
    }

    // Where the line stands now, so that the next change goes there.
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
            this.trouble.value = error.message;
        }
    }
}
