// Detects lines that are still being typed, so that they are not reported as errors.
import type { Command } from "../protocol";
import { type Bound, bind, findCommand, kLanguage, numbersIn } from "./commands";
import { isComputed, readLine } from "./words";

const kHeads: Record<string, RegExp> = {
    let: /^let\s+\w+\s*=\s*\S/,
    for: /^for\s+\w+\s+in\s+\S+.*\.\.\s*\S/,
    repeat: /^repeat\s+\S/,
    if: /^if\s+\S/,
};

function isHalf({ argument, words }: Bound, line: string): boolean {
    const isEmpty = words.some((word) => word.text === "" && line[word.value] !== '"');
    const numbers = words.reduce((sum, word) => sum + numbersIn(word.text), 0);
    const fits = !argument.sizes || argument.sizes.includes(numbers) || words.some((word) => isComputed(word.text));
    return isEmpty || !fits;
}

/** Returns whether the line is incomplete; a line that only the engine can check counts as complete. */
export function unfinished(schema: readonly Command[], line: string): boolean {
    const { words, comment, open } = readLine(line);
    if (words.length === 0) {
        return false;
    }
    const text = line.slice(0, comment).trim();
    if (open || text.endsWith("\\") || text.lastIndexOf("${") > text.lastIndexOf("}")) {
        return true;
    }
    const first = words[0].text;
    if (kLanguage.some(({ name }) => name === first)) {
        return first in kHeads && !kHeads[first].test(text);
    }
    const found = findCommand(schema, words);
    if (!found) {
        return true;
    }
    const { bound, unknown } = bind(found.command, words.slice(found.used));
    const key = unknown.some(({ key, text: word }) => key === "" && found.command.arguments.some(({ name }) => name.startsWith(word)));
    const needs = found.command.arguments.some((argument) => argument.required && !bound.some((one) => one.argument === argument));
    return needs || key || bound.some((one) => isHalf(one, line));
}
