// Converts a statement to a list of words for each argument, and back to a line.
import type { Argument, Command } from "../protocol";
import { quoted } from "../tools/kit/words";
import { bind, findCommand, numbersIn } from "./commands";
import { isComputed, joined, readLine } from "./words";

/** Words as typed, by argument; arguments with their default have no entry. */
export type Values = Readonly<Record<string, readonly string[]>>;

export interface Call {
    command: Command;
    values: Values;
    comment: string; // with its #
}

/** The choice for a word: a unique prefix is sufficient. */
function spelledOut({ choices = [] }: Argument, word: string): string {
    const begun = choices.filter((choice) => choice.startsWith(word));
    return choices.includes(word) || begun.length !== 1 ? word : begun[0];
}

/** The values of a statement; null for blocks, statements of the language itself, and unknown commands. */
export function readCall(schema: readonly Command[], statement: string): Call | null {
    const text = joined(statement);
    const { words, comment, open } = readLine(text);
    const found = text.includes("\n") || open ? null : findCommand(schema, words);
    if (!found) {
        return null;
    }
    const { bound, unknown } = bind(found.command, words.slice(found.used));
    const values: Record<string, string[]> = {};
    for (const { argument, words: mine } of bound) {
        (values[argument.name] ??= []).push(spelledOut(argument, mine.map((word) => word.text).join(",")));
    }
    const twice = bound.some(({ argument }) => !argument.repeats && values[argument.name].length > 1);
    return unknown.length > 0 || twice ? null : { command: found.command, values, comment: text.slice(comment) };
}

/** Writes a word for a line; expressions are preserved. */
export function written(text: string): string {
    return quoted(text).replaceAll("$${", "${");
}

function swallows(argument: Argument, word: string): boolean {
    const most = Math.max(...(argument.sizes ?? [0]));
    return argument.type === "tuple" && !argument.repeats && (isComputed(word) || numbersIn(word) < most);
}

/** The line with these values. Arguments without a value are omitted. */
export function lineOf(command: Command, values: Values, comment = ""): string {
    const words = [command.name];
    const options: string[] = [];
    let inOrder = true; // an argument after an omitted one requires its name
    for (const argument of command.arguments) {
        const mine = values[argument.name] ?? [];
        if (argument.positional && inOrder) {
            words.push(...mine.map(written));
            inOrder = mine.length > 0 && !swallows(argument, mine[0]);
        } else {
            options.push(...mine.map((word) => `${argument.name}=${written(word)}`));
        }
    }
    return [...words, ...options, ...(comment ? [comment] : [])].join(" ");
}

/** The default of an argument, as typed; empty if there is no default. */
export function defaultWord(argument: Argument, values: Values): string {
    const word = argument.default ?? "";
    return word.startsWith("@") ? (values[word.slice(1)]?.[0] ?? "") : word;
}

/** The first word of an argument, or its default. */
export function wordOf(argument: Argument, values: Values): string {
    return values[argument.name]?.[0] ?? defaultWord(argument, values);
}

function same(argument: Argument, word: string, other: string): boolean {
    if (word === other) {
        return true;
    }
    if (!["number", "whole", "tuple"].includes(argument.type) || other === "") {
        return false;
    }
    const [a, b] = [word.split(","), other.split(",")];
    return a.length === b.length && a.every((part, i) => part.trim() !== "" && Number(part) === Number(b[i]));
}

/** Replaces a value; a value equal to the default is omitted, except for a seed, because `set seed` changes its default. */
export function withValue(argument: Argument, values: Values, words: readonly string[]): Values {
    const kept = words.filter((word) => word !== "");
    const { [argument.name]: _, ...rest } = values;
    const isDefault = kept.length === 1 && argument.name !== "seed" && same(argument, kept[0], defaultWord(argument, values));
    return kept.length === 0 || (isDefault && !argument.required) ? rest : { ...rest, [argument.name]: kept };
}

/** The required arguments that have no value. */
export function missing(command: Command, values: Values): Argument[] {
    return command.arguments.filter(({ required, name }) => required && (values[name] ?? []).length === 0);
}
