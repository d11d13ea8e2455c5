// The words of a line of a scene and their positions, with the rules of the engine.

export interface Word {
    key: string; // name in name=value; empty for a positional word
    text: string; // the value, without quotes
    from: number; // offset of the whole word in the line
    value: number; // offset of its value, including the quote
    to: number;
}

export interface Line {
    words: Word[];
    comment: number; // offset of the comment; the length of the line if there is no comment
    open: boolean; // whether a quote is not closed
}

const kBlank = /[ \t\r\n]/;

/** A statement as one line of the same length: continued lines are joined. */
export function joined(text: string): string {
    return text.replace(/\\\r?\n/g, (end) => " ".repeat(end.length));
}

function endOfPlain(line: string, from: number, closes: number): number {
    let at = from;
    for (; at < line.length && !kBlank.test(line[at]); ++at) {
        if (at < closes && line.startsWith("${", at)) {
            at = line.indexOf("}", at); // blanks in an expression belong to the word
        }
    }
    return at;
}

function endOfQuoted(line: string, quote: number): { to: number; closed: boolean } {
    for (let at = quote + 1; at < line.length; ++at) {
        if (line[at] === '"') {
            return { to: at + 1, closed: true };
        }
        if (line[at] === "\\" && (line[at + 1] === '"' || line[at + 1] === "\\")) {
            ++at;
        }
    }
    return { to: line.length, closed: false };
}

/** The words of one line. */
export function readLine(line: string): Line {
    const closes = line.lastIndexOf("}");
    const words: Word[] = [];
    let open = false;
    for (let at = 0; at < line.length;) {
        if (kBlank.test(line[at])) {
            ++at;
            continue;
        }
        if (line[at] === "#") {
            return { words, comment: at, open };
        }
        const key = /^[a-z0-9_]+(?==)/.exec(line.slice(at))?.[0] ?? "";
        const value = key === "" ? at : at + key.length + 1;
        if (line[value] === '"') {
            const { to, closed } = endOfQuoted(line, value);
            const text = line.slice(value + 1, closed ? to - 1 : to).replace(/\\(["\\])/g, "$1");
            words.push({ key, text, from: at, value, to });
            open = !closed;
            at = to;
        } else {
            const to = endOfPlain(line, value, closes);
            words.push({ key, text: line.slice(value, to), from: at, value, to });
            at = to;
        }
    }
    return { words, comment: line.length, open };
}

/** Returns whether a text contains an expression that the scene evaluates. */
export function isComputed(text: string): boolean {
    return text.replaceAll("$${", "").includes("${");
}
