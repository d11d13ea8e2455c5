// Splits a line into tokens for colouring.
import type { Argument, Command } from "../../../protocol";
import { bind, findCommand, kLanguage } from "../../../script/commands";
import { readLine, type Word } from "../../../script/words";

export type TokenKind = "command" | "language" | "key" | "name" | "number" | "string" | "choice" | "expression" | "comment" | "unknown";

export interface Token {
    from: number;
    to: number;
    kind: TokenKind;
}

const kNumbers = /^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?:,[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)*$/;

function valueKind(argument: Argument | undefined, word: Word, line: string): TokenKind | null {
    switch (argument?.type) {
        case "new_name":
        case "object":
        case "section":
            return "name";
        case "choice":
        case "flag":
            return "choice";
        default:
            return kNumbers.test(word.text) ? "number" : line[word.value] === '"' ? "string" : null;
    }
}

/** A value; the expressions in it are separate tokens. */
function valueTokens(line: string, word: Word, kind: TokenKind | null): Token[] {
    const tokens: Token[] = [];
    let at = word.value;
    const put = (to: number, which: TokenKind | null) => {
        if (which && to > at) {
            tokens.push({ from: at, to, kind: which });
        }
        at = to;
    };
    for (const match of line.slice(word.value, word.to).matchAll(/(?<!\$)\$\{[^}]*\}?/g)) {
        put(word.value + match.index, kind);
        put(at + match[0].length, "expression");
    }
    put(word.to, kind);
    return tokens;
}

function languageTokens(line: string, words: readonly Word[], end: number): Token[] {
    const tokens: Token[] = [{ from: words[0].from, to: words[0].to, kind: "language" }];
    const pattern = /"(?:[^"\\]|\\.)*"?|\b\d+\.?\d*(?:[eE][-+]?\d+)?|\b(?:in|step|and|or|not)\b/g;
    pattern.lastIndex = words[0].to;
    for (let match = pattern.exec(line); match && match.index < end; match = pattern.exec(line)) {
        const kind = match[0].startsWith('"') ? "string" : /^\d/.test(match[0]) ? "number" : "language";
        tokens.push({ from: match.index, to: match.index + match[0].length, kind });
    }
    return tokens;
}

function commandTokens(line: string, words: readonly Word[], found: { command: Command; used: number }): Token[] {
    const name = words.slice(0, found.used).map(({ from, to }): Token => ({ from, to, kind: "command" }));
    const { bound, unknown } = bind(found.command, words.slice(found.used));
    const of = new Map(bound.flatMap(({ argument, words: mine }) => mine.map((word) => [word, argument] as const)));
    const rest = words.slice(found.used).flatMap((word): Token[] => {
        if (unknown.includes(word)) {
            return [{ from: word.from, to: word.to, kind: "unknown" }];
        }
        const key: Token[] = word.key === "" ? [] : [{ from: word.from, to: word.value, kind: "key" }];
        return [...key, ...valueTokens(line, word, valueKind(of.get(word), word, line))];
    });
    return [...name, ...rest];
}

/** The coloured tokens of a line, in order. `continues`: it continues the previous line. */
export function tokensOf(schema: readonly Command[], line: string, continues = false): Token[] {
    const { words, comment } = readLine(line);
    const tokens: Token[] = [];
    const found = continues ? null : findCommand(schema, words);
    if (words.length > 0 && !continues && kLanguage.some(({ name }) => name === words[0].text)) {
        tokens.push(...languageTokens(line, words, comment));
    } else if (found) {
        tokens.push(...commandTokens(line, words, found));
    } else {
        tokens.push(...words.flatMap((word) => valueTokens(line, word, valueKind(undefined, word, line))));
    }
    if (comment < line.length) {
        tokens.push({ from: comment, to: line.length, kind: "comment" });
    }
    return tokens;
}
