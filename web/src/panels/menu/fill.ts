// Lines of menu items: the text that the page inserts before they run.
import type { Argument, Command, Kind } from "../../protocol";
import { bind, findCommand, kindsOf, kKinds, numbersIn } from "../../script/commands";
import { written } from "../../script/values";
import { isComputed, readLine } from "../../script/words";
import { newName } from "../../tools/kit/words";

export type Part =
    { is: "text"; text: string } | { is: "new"; base: string } | { is: "object" } | { is: "ask"; label: string; value: string; argument?: Argument }; // the proposed value; the argument for the answer

const kHole = /(?<!\$)\$\{(?:(new)\s+([A-Za-z][\w.-]*)|(object)|(ask)\s+([^,}]+?)\s*(?:,\s*([^}]*?)\s*)?)\}/g;

/** A line with its placeholders `${new BASE}`, `${object}` and `${ask LABEL, DEFAULT}`; other `${...}` belong to the scene. */
export function partsOf(line: string): Part[] {
    const parts: Part[] = [];
    let at = 0;
    for (const match of line.matchAll(kHole)) {
        parts.push({ is: "text", text: line.slice(at, match.index) });
        if (match[1]) {
            parts.push({ is: "new", base: match[2] });
        } else if (match[3]) {
            parts.push({ is: "object" });
        } else {
            parts.push({ is: "ask", label: match[5], value: match[6] ?? "" });
        }
        at = match.index + match[0].length;
    }
    parts.push({ is: "text", text: line.slice(at) });
    return parts.filter((part) => part.is !== "text" || part.text !== "");
}

/** The argument for each part, if the schema has the command; undefined for text. */
export function argumentsOf(schema: readonly Command[], parts: readonly Part[]): (Argument | undefined)[] {
    const mark = (at: number) => `hole-${at}-`; // begins like a name, so that it is valid at every position of a name
    const { words } = readLine(parts.map((part, at) => (part.is === "text" ? part.text : mark(at))).join(""));
    const found = findCommand(schema, words);
    const bound = found ? bind(found.command, words.slice(found.used)).bound : [];
    return parts.map((part, at) => (part.is === "text" ? undefined : bound.find((one) => one.words.some(({ text }) => text.includes(mark(at))))?.argument));
}

/** The kinds of the selected object that the line accepts; null if it does not use one. */
export function requestedKinds(schema: readonly Command[], line: string): readonly Kind[] | null {
    const parts = partsOf(line);
    const found = argumentsOf(schema, parts).filter((_, at) => parts[at].is === "object");
    const kinds = found.map((argument) => (argument ? kindsOf(argument) : null));
    return found.length === 0 ? null : (kinds.find((some) => some !== null && some.length > 0) ?? kKinds);
}

export interface Filling {
    object: string; // name of the selected one
    answers: readonly string[]; // for each ${ask}, in order
}

const kQuoted = new Set<Argument["type"]>(["word", "input_file", "output_file", "properties"]);

/** The line to run. The engine chooses the names of new objects, because it knows the free ones. */
export function filled(parts: readonly Part[], filling: Filling, schema: readonly Command[]): string {
    const partArguments = argumentsOf(schema, parts);
    let answerIndex = 0;
    const words = parts.map((part, at) => {
        switch (part.is) {
            case "text":
                return part.text;
            case "object":
                return filling.object;
            case "new":
                return newName(part.base);
            case "ask": {
                const answer = filling.answers[answerIndex++]?.trim() ?? "";
                const type = partArguments[at]?.type;
                return type && kQuoted.has(type) ? written(answer) : answer;
            }
        }
    });
    return words.join("");
}

/** The error in an answer that can be detected before the line runs; otherwise empty. */
export function answerError(answer: string, argument: Argument | undefined, objects: readonly { kind: Kind; name: string }[]): string {
    const text = answer.trim();
    if (text === "") {
        return "Enter a value.";
    }
    if (!argument || isComputed(text)) {
        return "";
    }
    const limits = argument.low !== undefined && argument.high !== undefined ? ` from ${argument.low} to ${argument.high}` : "";
    const within = (value: number) => value >= (argument.low ?? -Infinity) && value <= (argument.high ?? Infinity);
    switch (argument.type) {
        case "number":
            return numbersIn(text) === 1 && within(Number(text)) ? "" : `Enter a number${limits}.`;
        case "whole":
            return numbersIn(text) === 1 && Number.isInteger(Number(text)) && within(Number(text)) ? "" : `Enter a whole number${limits}.`;
        case "tuple": {
            const count = numbersIn(text.replace(/\s*,\s*|\s+/g, ","));
            return count > 0 && (argument.sizes ?? [count]).includes(count) ? "" : `Enter ${(argument.sizes ?? []).join(" or ")} numbers separated by commas.`;
        }
        case "choice": {
            const { choices = [] } = argument;
            const meant = choices.includes(text) ? 1 : choices.filter((choice) => choice.startsWith(text)).length;
            return meant === 1 ? "" : `Enter one of ${choices.join(", ")}.`;
        }
        case "flag":
            return text === "true" || text === "false" ? "" : "Enter true or false.";
        case "new_name":
            return /^[A-Za-z][\w.-]{0,63}$/.test(text) ? "" : "A name is a letter, followed by letters, digits, _, - and dots.";
        case "object": {
            const kinds = kindsOf(argument);
            return objects.some((object) => object.name === text && kinds.includes(object.kind))
                ? ""
                : `There is no ${kinds.length > 2 ? "object" : kinds.join(" or ")} ${text}.`;
        }
        default:
            return "";
    }
}
