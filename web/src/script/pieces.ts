// Statements of a scene's text: a line with those that it goes on in, or a whole block, as the engine divides it.

export interface Piece {
    text: string; // as it stands, without the last line end
    line: number; // of its first line, from 1
    from: number; // in the whole text
    open: boolean; // whether a block or a line that goes on has no end
}

const kOpens = new Set(["for", "repeat", "if"]);

function firstWord(line: string): string {
    return /^[ \t\r]*([a-z]+)(?=[ \t\r]|$)/.exec(line)?.[1] ?? "";
}

/** The text in statements; joined by line ends they are the text again, but for an end behind the last. */
export function piecesOf(text: string): Piece[] {
    const pieces: Piece[] = [];
    const lines = text.split("\n");
    if (lines.at(-1) === "") {
        lines.pop();
    }
    let depth = 0;
    let goesOn = false;
    let from = 0;
    lines.forEach((line, i) => {
        const piece = pieces.at(-1);
        if (piece && (depth > 0 || goesOn)) {
            piece.text += `\n${line}`;
        } else {
            pieces.push({ text: line, line: i + 1, from, open: false });
        }
        const word = goesOn ? "" : firstWord(line);
        depth += kOpens.has(word) ? 1 : word === "end" && depth > 0 ? -1 : 0;
        goesOn = /\\\r?$/.test(line);
        from += line.length + 1;
    });
    const last = pieces.at(-1);
    if (last) {
        last.open = depth > 0 || goesOn;
    }
    return pieces;
}

/** The number of the statement that a line (from 1) belongs to; that of the last one for lines behind it. */
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

/** The commands of a statement, each as one line and where it begins in the statement: several in a block. */
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

/** The text of a document of statements. */
export function textOf(statements: readonly { text: string }[]): string {
    return statements.map(({ text }) => `${text}\n`).join("");
}
