// Statements in the text of a scene: a line with its continuation lines, or a whole block, with the rules of the engine.

export interface Piece {
    text: string; // source text without the last line end
    line: number; // number of its first line, from 1
    from: number; // offset in the whole text
    open: boolean; // whether a block or a continued line has no end
}

const kOpens = new Set(["for", "repeat", "if"]);

function firstWord(line: string): string {
    return /^[ \t\r]*([a-z]+)(?=[ \t\r]|$)/.exec(line)?.[1] ?? "";
}

/** Splits the text into statements; joined by line ends they are the same text, except for a line end after the last. */
export function piecesOf(text: string): Piece[] {
    const pieces: Piece[] = [];
    const lines = text.split("\n");
    if (lines.at(-1) === "") {
        lines.pop();
    }
    let depth = 0;
    let continues = false;
    let from = 0;
    lines.forEach((line, i) => {
        const piece = pieces.at(-1);
        if (piece && (depth > 0 || continues)) {
            piece.text += `\n${line}`;
        } else {
            pieces.push({ text: line, line: i + 1, from, open: false });
        }
        const word = continues ? "" : firstWord(line);
        depth += kOpens.has(word) ? 1 : word === "end" && depth > 0 ? -1 : 0;
        continues = /\\\r?$/.test(line);
        from += line.length + 1;
    });
    const last = pieces.at(-1);
    if (last) {
        last.open = depth > 0 || continues;
    }
    return pieces;
}

/** Index of the statement that contains a line (from 1); the last statement for lines after it. */
export function pieceAt(pieces: readonly { line: number }[], line: number): number {
    let low = 0;
    let high = pieces.length;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (pieces[middle].line <= line) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low - 1;
}

/** The commands of a statement, each as one line with its offset in the statement: several in a block. */
export function linesOf(statement: string): { text: string; from: number }[] {
    const lines: { text: string; from: number }[] = [];
    const pattern = /(?:[^\n]*\\\r?\n)*[^\n]*(?:\n|$)/y;
    while (pattern.lastIndex < statement.length) {
        const from = pattern.lastIndex;
        const match = pattern.exec(statement);
        if (!match || match[0] === "") {
            break;
        }
        const text = match[0].replace(/\n$/, "").replace(/\\\r?\n/g, (end) => " ".repeat(end.length));
        lines.push({ text, from });
    }
    return lines;
}

/** The text of a document from its statements. */
export function textOf(statements: readonly { text: string }[]): string {
    return statements.map(({ text }) => `${text}\n`).join("");
}
