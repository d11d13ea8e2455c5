// Synchronization of typed text and document: they differ for a time, and both may change during it.
import { difference, merged } from "../../../script/merge";

/** A normalized text for comparisons: with a final line end, and uniform line ends. */
export function normal(text: string): string {
    const lines = text.replace(/\r\n?/g, "\n");
    return lines === "" || lines.endsWith("\n") ? lines : `${lines}\n`;
}

export class Sync {
    /** The requested text of the document, until the response. */
    sent: string | null = null;

    private known = ""; // the text of the document on which the typed text is based
    private other: string | null = null; // the text of the document after it changed in lines that are being typed

    /** The text of the document that has been merged into the typed text. */
    get base(): string {
        return this.known;
    }

    /** The text of the document, if it conflicts with the typed text. */
    get theirs(): string | null {
        return this.other;
    }

    isTyped(mine: string): boolean {
        return normal(mine) !== this.known;
    }

    /** Begins with text that was typed into an earlier text of the document. */
    begin(base: string): void {
        this.known = base;
    }

    /** Receives the current document. Returns the text for the editor. */
    receive(document: string, mine: string): string {
        const theirs = normal(document);
        const own = normal(mine);
        if (theirs === this.known || theirs === this.sent) {
            this.known = theirs; // text typed since then is a change of it
            this.other = null;
            return mine;
        }
        const both = own === this.known ? theirs : own === theirs ? own : merged(this.known, own, theirs);
        if (both === null) {
            this.other = theirs;
            return mine;
        }
        this.known = theirs;
        this.other = null;
        return both === own ? mine : both;
    }

    /** Ends a conflict: if both changed the same lines, one version is kept. */
    settle(mine: string, prefer: "mine" | "theirs"): string {
        if (this.other === null) {
            return mine;
        }
        const both = merged(this.known, normal(mine), this.other, prefer) ?? mine;
        this.known = this.other;
        this.other = null;
        return both;
    }
}

export interface Change {
    from: number;
    to: number;
    insert: string;
}

/** The minimum change between two texts. */
function minChange(before: string, after: string, at: number): Change {
    const most = Math.min(before.length, after.length);
    let first = 0;
    while (first < most && before[first] === after[first]) {
        ++first;
    }
    let last = 0;
    while (last < most - first && before[before.length - 1 - last] === after[after.length - 1 - last]) {
        ++last;
    }
    return { from: at + first, to: at + before.length - last, insert: after.slice(first, after.length - last) };
}

/** The changes between two texts; equal lines are not replaced, so that cursors in them stay. */
export function changesBetween(before: string, after: string): Change[] {
    const lines = before.split("\n");
    const starts = [0];
    lines.forEach((line, i) => starts.push(starts[i] + line.length + 1));
    return difference(lines, after.split("\n")).map((hunk) => {
        const old = lines.slice(hunk.from, hunk.to);
        if (hunk.to < lines.length) {
            return minChange(old.map((line) => `${line}\n`).join(""), hunk.lines.map((line) => `${line}\n`).join(""), starts[hunk.from]);
        }
        if (hunk.from === 0) {
            return minChange(before, after, 0);
        }
        // The last line has no line end; it is changed together with the end of the previous line.
        return minChange(old.map((line) => `\n${line}`).join(""), hunk.lines.map((line) => `\n${line}`).join(""), starts[hunk.from] - 1);
    });
}
