// What is typed and what the document is: they differ for a while, and both may change meanwhile.
import { difference, merged } from "../../../script/merge";

/** A text as it is compared: with an end behind its last line, of one kind. */
export function normal(text: string): string {
    const lines = text.replace(/\r\n?/g, "\n");
    return lines === "" || lines.endsWith("\n") ? lines : `${lines}\n`;
}

export class Sync {
    /** What the document was asked to become, until that is answered. */
    sent: string | null = null;

    private known = ""; // the text of the document that what is typed was made of
    private other: string | null = null; // what the document became while the same lines were typed

    /** The text of the document, as far as what is typed takes it in. */
    get base(): string {
        return this.known;
    }

    /** What the document is, where it cannot be put together with what is typed. */
    get theirs(): string | null {
        return this.other;
    }

    isTyped(mine: string): boolean {
        return normal(mine) !== this.known;
    }

    /** Begins with what was typed into another text than the document is now. */
    begin(base: string): void {
        this.known = base;
    }

    /** Takes in what the document is now. Returns what the editor has to show. */
    receive(document: string, mine: string): string {
        const theirs = normal(document);
        const own = normal(mine);
        if (theirs === this.known || theirs === this.sent) {
            this.known = theirs; // what was typed since is a change of that
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

    /** Ends a conflict: where both changed the same lines, these or those are kept. */
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

/** The least change that makes one text another. */
function leastChange(before: string, after: string, at: number): Change {
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

/** The changes that make one text another; lines that stay are not touched, so that cursors in them stay too. */
export function changesBetween(before: string, after: string): Change[] {
    const lines = before.split("\n");
    const starts = [0];
    lines.forEach((line, i) => starts.push(starts[i] + line.length + 1));
    return difference(lines, after.split("\n")).map((hunk) => {
        const old = lines.slice(hunk.from, hunk.to);
        if (hunk.to < lines.length) {
            return leastChange(old.map((line) => `${line}\n`).join(""), hunk.lines.map((line) => `${line}\n`).join(""), starts[hunk.from]);
        }
        if (hunk.from === 0) {
            return leastChange(before, after, 0);
        }
        // The last line has no end of its own; it goes with that of the line before it.
        return leastChange(old.map((line) => `\n${line}`).join(""), hunk.lines.map((line) => `\n${line}`).join(""), starts[hunk.from] - 1);
    });
}
