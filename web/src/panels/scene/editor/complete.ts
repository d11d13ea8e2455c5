// Completion: commands and arguments from the schema, names from the engine, which knows the objects at that line.
import { type Completion, type CompletionContext, type CompletionResult, startCompletion } from "@codemirror/autocomplete";
import type { App } from "../../../app";
import type { Argument, Command, SceneObject } from "../../../protocol";
import { bind, findCommand, kLanguage, shortUnit } from "../../../script/commands";
import { readLine, type Word } from "../../../script/words";
import { argumentHelp } from "./help";

const kFunctions = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "exp", "log", "abs", "floor", "ceil", "round", "min", "max", "random", "pi"];

export interface CompletionTarget {
    from: number; // offset of the word in the line
    text: string; // text of it so far
    type: "command" | "word" | "expression";
}

/** The word before the cursor that may be completed; null if there is no completion. */
export function completionAt(before: string): CompletionTarget | null {
    const expression = /(?<!\$)\$\{(?:[^}]*[^}\w])?(\w*)$/.exec(before);
    if (expression) {
        return { from: before.length - expression[1].length, text: expression[1], type: "expression" };
    }
    const { words, comment, open } = readLine(before);
    if (comment < before.length || open) {
        return null;
    }
    const last = words.at(-1)?.to === before.length ? words[words.length - 1] : undefined;
    const from = last?.from ?? before.length;
    return { from, text: before.slice(from), type: words.length - (last ? 1 : 0) === 0 ? "command" : "word" };
}

/** All commands by their full names, and the statements of the language itself. */
export function commandCompletions(schema: readonly Command[]): Completion[] {
    return [
        ...schema.map(({ name, help, group, example }): Completion => ({ label: name, type: "function", detail: group, info: `${help}\n\n${example}` })),
        ...kLanguage.map(({ name, usage, help }): Completion => ({ label: name, type: "keyword", detail: usage, info: help })),
    ];
}

function argumentOf(schema: readonly Command[], words: readonly Word[]): { command: Command; next: Argument | undefined } | null {
    const found = findCommand(schema, words);
    if (!found) {
        return null;
    }
    const { command, used } = found;
    const given = new Set(bind(command, words.slice(used)).bound.map(({ argument }) => argument));
    return { command, next: command.arguments.find((argument) => argument.positional && (!given.has(argument) || argument.repeats)) };
}

/** Explanation of a word that the engine offers. */
export function wordCompletion(schema: readonly Command[], before: string, word: string, objects: readonly SceneObject[]): Completion {
    const { words } = readLine(before);
    const known = argumentOf(schema, words);
    const key = /^([a-z0-9_]+)=/.exec(word)?.[1];
    const argument = key ? known?.command.arguments.find(({ name }) => name === key) : known?.next;
    const value = key ? word.slice(key.length + 1) : word;
    if (key && argument && value === "") {
        const lists = argument.type === "choice" || argument.type === "flag" || argument.type === "object";
        return {
            label: word,
            type: "property",
            detail: shortUnit(argument),
            info: argumentHelp(argument).text,
            apply: (view, _, from, to) => {
                view.dispatch({ changes: { from, to, insert: word }, selection: { anchor: from + word.length }, userEvent: "input.complete" });
                if (lists) {
                    startCompletion(view);
                }
            },
        };
    }
    const kinds = objects.filter(({ name }) => name === value).map(({ kind }) => kind);
    const family = schema.filter(({ name }) => name === `${words[0]?.text} ${word}`);
    if (family.length > 0) {
        return { label: word, type: "function", info: family[0].help };
    }
    return { label: word, type: kinds.length > 0 ? "variable" : "enum", detail: kinds.join(", "), info: argument && argumentHelp(argument).text };
}

function variablesAbove(context: CompletionContext, line: number): Completion[] {
    const names = new Set<string>();
    for (let n = 1; n < line; ++n) {
        const match = /^\s*(?:let|for)\s+(\w+)/.exec(context.state.doc.line(n).text);
        if (match) {
            names.add(match[1]);
        }
    }
    return [...[...names].map((label): Completion => ({ label, type: "variable" })), ...kFunctions.map((label): Completion => ({ label, type: "function" }))];
}

/** `countAbove`: number of statements before a line. */
export function completions(app: App, countAbove: (line: number) => number): (context: CompletionContext) => Promise<CompletionResult | null> {
    return async (context) => {
        const line = context.state.doc.lineAt(context.pos);
        const before = line.text.slice(0, context.pos - line.from);
        const target = completionAt(before);
        if (!target || (target.text === "" && !context.explicit)) {
            return null;
        }
        const from = line.from + target.from;
        const other = (options: Completion[]) => options.filter(({ label }) => label !== target.text);
        if (target.type === "expression") {
            return { from, options: other(variablesAbove(context, line.number)), validFor: /^\w*$/ };
        }
        const schema = app.store.schema.peek();
        if (target.type === "command") {
            return { from, options: other(commandCompletions(schema)), validFor: /^[\w ]*$/ };
        }
        const count = countAbove(line.number);
        const { words } = await app.engine.request<{ words: string[] }>("complete", { line: before.trimStart(), count }).catch(() => ({ words: [] }));
        const objects = app.store.state.peek().objects;
        const done = before.slice(0, target.from);
        const options = other(words.map((word) => wordCompletion(schema, done, word, objects)));
        return { from, options, validFor: target.text.includes("=") ? /^[a-z0-9_]+=[\w.-]*$/ : /^[\w.-]*$/ };
    };
}
