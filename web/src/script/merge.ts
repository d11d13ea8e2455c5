// Merges two changes of the same text, line by line.

interface Hunk {
    from: number; // lines of the old text
    to: number;
    lines: string[]; // new lines at this position
}

const kMaxCells = 4_000_000; // maximum size of the table of common lines; above it, everything between the common prefix and suffix counts as changed

function hunksBetween(a: readonly string[], b: readonly string[], offset: number): Hunk[] {
    const width = b.length + 1;
    if (a.length === 0 || b.length === 0 || (a.length + 1) * width > kMaxCells) {
        return [{ from: offset, to: offset + a.length, lines: [...b] }];
    }
    const common = new Uint32Array((a.length + 1) * width); // number of common lines in the remaining text
    for (let i = a.length - 1; i >= 0; --i) {
        for (let j = b.length - 1; j >= 0; --j) {
            const right = common[i * width + j + 1];
            const below = common[(i + 1) * width + j];
            common[i * width + j] = a[i] === b[j] ? common[(i + 1) * width + j + 1] + 1 : Math.max(right, below);
        }
    }
    const hunks: Hunk[] = [];
    let hunk: Hunk | null = null;
    for (let i = 0, j = 0; i < a.length || j < b.length;) {
        if (i < a.length && j < b.length && a[i] === b[j]) {
            hunk = null;
            ++i;
            ++j;
            continue;
        }
        if (!hunk) {
            hunk = { from: offset + i, to: offset + i, lines: [] };
            hunks.push(hunk);
        }
        if (j >= b.length || (i < a.length && common[(i + 1) * width + j] >= common[i * width + j + 1])) {
            ++i;
            ++hunk.to;
        } else {
            hunk.lines.push(b[j]);
            ++j;
        }
    }
    return hunks;
}

/** Returns the hunks of `a` that differ in `b`. */
export function difference(a: readonly string[], b: readonly string[]): Hunk[] {
    let first = 0;
    while (first < a.length && first < b.length && a[first] === b[first]) {
        ++first;
    }
    let last = 0;
    while (last < a.length - first && last < b.length - first && a[a.length - 1 - last] === b[b.length - 1 - last]) {
        ++last;
    }
    if (a.length === b.length && first === a.length) {
        return [];
    }
    return hunksBetween(a.slice(first, a.length - last), b.slice(first, b.length - last), first);
}

/** Returns whether two hunks change the same lines, or are the same change. */
function overlap(a: Hunk, b: Hunk): boolean {
    const same = a.from === b.from && a.to === b.to && a.lines.join("\n") === b.lines.join("\n");
    return same || (a.from < b.to && b.from < a.to);
}

function applied(base: readonly string[], hunks: readonly Hunk[], from: number, to: number): string[] {
    const out: string[] = [];
    let at = from;
    for (const hunk of hunks) {
        out.push(...base.slice(at, hunk.from), ...hunk.lines);
        at = hunk.to;
    }
    return [...out, ...base.slice(at, to)];
}

/** Applies both changes to `base`; null if they change the same lines and neither is preferred. */
export function merged(base: string, mine: string, theirs: string, prefer?: "mine" | "theirs"): string | null {
    const old = base.split("\n");
    const own = difference(old, mine.split("\n"));
    const other = difference(old, theirs.split("\n"));
    const out: string[] = [];
    let at = 0;
    let i = 0;
    let j = 0;
    while (i < own.length || j < other.length) {
        // If both insert lines at the same position, theirs come first, because they are already in the document.
        const otherFirst = j < other.length && (i >= own.length || other[j].from <= own[i].from);
        const group = otherFirst ? { own: [] as Hunk[], other: [other[j++]] } : { own: [own[i++]], other: [] as Hunk[] };
        for (let more = true; more;) {
            more = false;
            if (i < own.length && group.other.some((hunk) => overlap(hunk, own[i]))) {
                group.own.push(own[i++]);
                more = true;
            }
            if (j < other.length && group.own.some((hunk) => overlap(hunk, other[j]))) {
                group.other.push(other[j++]);
                more = true;
            }
        }
        const all = [...group.own, ...group.other];
        const from = Math.min(...all.map((hunk) => hunk.from));
        const to = Math.max(...all.map((hunk) => hunk.to));
        const ours = applied(old, group.own, from, to);
        const others = applied(old, group.other, from, to);
        const alike = group.own.length > 0 && ours.length === others.length && ours.every((line, k) => line === others[k]);
        if (group.own.length > 0 && group.other.length > 0 && !alike && !prefer) {
            return null;
        }
        const takeOurs = group.other.length === 0 || (group.own.length > 0 && prefer === "mine");
        out.push(...old.slice(at, from), ...(takeOurs ? ours : others));
        at = to;
    }
    return [...out, ...old.slice(at)].join("\n");
}
