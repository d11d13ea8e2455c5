// The statement that created an object, as text: its control points are read, changed and written back.
import type { App } from "../../app";
import type { ObjectName, State } from "../../protocol";
import { isComputed, joined, readLine } from "../../script/words";

export interface Word {
    key: string; // name in name=value; empty for a positional word
    text: string; // without quotes
    raw: string; // source text
}

/** The words of one command, or null if it contains expressions, or is a block. */
export function wordsOf(statement: string): { words: Word[]; comment: string } | null {
    const line = joined(statement);
    if (/[\r\n]/.test(line.trim()) || isComputed(line)) {
        return null;
    }
    const { words, comment } = readLine(line);
    return { words: words.map(({ key, text, from, to }) => ({ key, text, raw: line.slice(from, to) })), comment: line.slice(comment) };
}

export interface Controls {
    statement: number; // in the document
    command: string;
    name: string;
    points: number[][];
    options: Record<string, string>;
    comment: string;
}

/** The control points of a statement `COMMAND NAME POINTS... options`; null for other statements. */
export function controlsOf(text: string, statement: number, commands: readonly string[]): Controls | null {
    const read = wordsOf(text.trim());
    const inOrder = read?.words.filter(({ key }) => key === "") ?? [];
    if (!read || inOrder.length < 2 || !commands.includes(inOrder[0].text)) {
        return null;
    }
    const points = inOrder.slice(2).map(({ text: point }) => point.split(",").map(Number));
    if (points.some((point) => point.some((value) => !Number.isFinite(value)))) {
        return null;
    }
    const options = Object.fromEntries(read.words.filter(({ key }) => key !== "").map(({ key, text: value }) => [key, value]));
    return { statement, command: inOrder[0].text, name: inOrder[1].text, points, options, comment: read.comment };
}

/** The newest statement that created an object from control points; null if a later statement may have moved it. */
export function findControls(state: State, object: ObjectName, commands: readonly string[]): Controls | null {
    const creator = state.objects.find(({ kind, name }) => kind === object.kind && name === object.name)?.statement ?? -1;
    const controls = creator >= 0 ? controlsOf(state.statements[creator]?.text ?? "", creator, commands) : null;
    return controls?.name === object.name ? controls : null;
}

/** The text of the document with changed statements; null removes one. Blank lines between statements are preserved. */
export function documentText(state: State, changes: ReadonlyMap<number, string | null>): string {
    let out = "";
    let line = 1;
    let grown = 0; // number of lines that the changed statements have gained
    state.statements.forEach((statement, i) => {
        for (; line < statement.line + grown; ++line) {
            out += "\n";
        }
        const before = `${statement.text.replace(/\n$/, "")}\n`;
        const change = changes.get(i);
        const now = change === undefined ? before : change === null ? "" : `${change}\n`;
        out += now;
        line += linesIn(now);
        grown += linesIn(now) - linesIn(before);
    });
    return out;
}

function linesIn(text: string): number {
    return text.split("\n").length - 1;
}

/**
 * Rewrites one statement; objects that depend on it are recomputed. Changes with the same name are undone together if they join.
 * Throws if the change is refused.
 */
export async function rewriteStatement(app: App, statement: number, text: string, name?: string, joins = name !== undefined): Promise<void> {
    const state = app.store.state.peek();
    await app.engine.request("text", { text: documentText(state, new Map([[statement, text]])), revision: state.revision, name, joins });
}

interface Rewrite {
    statement: number;
    text: string;
    name: string;
    joins: boolean;
}

let waiting: Rewrite | null = null;
let rewriting: Promise<void> | null = null;

/**
 * The same, and reports a refusal. One at a time: during a request the newest change waits, and includes the changes that waited
 * before.
 */
export function replaceStatement(app: App, rewrite: Rewrite): Promise<void> {
    waiting = rewrite;
    rewriting ??= rewriteAll(app).finally(() => {
        rewriting = null;
    });
    return rewriting;
}

async function rewriteAll(app: App): Promise<void> {
    for (let next = waiting; next; next = waiting) {
        waiting = null;
        try {
            await rewriteStatement(app, next.statement, next.text, next.name, next.joins);
        } catch (error) {
            app.store.notify((error as Error).message, "error");
            await app.engine.endPreview().catch(() => undefined);
        }
    }
}
