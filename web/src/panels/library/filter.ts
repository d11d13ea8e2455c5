// Which branches of a library are shown, in which order, and how arrow keys go through them.
import type { Values } from "../../script/values";

/** As the request `library` tells of it. */
export interface Branch {
    number: number;
    source: string;
    tags: string[];
    leads: boolean; // it goes on with its host
    length: number; // [m] of all segments
    volume: number; // [m^3]
    extent: number; // [m]
    nodes: number;
    tips: number;
    orders: number;
    radius: number; // [m]
}

export interface Filter {
    text: string; // in a tag, the source or the number
    tag: string; // all where empty
    least: number; // [m] of length
    most: number; // 0: any
}

export const kAll: Filter = { text: "", tag: "", least: 0, most: 0 };
export type Order = "number" | "length" | "tips";

export function filtered(branches: readonly Branch[], { text, tag, least, most }: Filter, order: Order): Branch[] {
    const words = text.trim().toLowerCase();
    const says = (branch: Branch) => [String(branch.number), branch.source, ...branch.tags].some((word) => word.toLowerCase().includes(words));
    return branches
        .filter((branch) => (words === "" || says(branch)) && (tag === "" || branch.tags.includes(tag)))
        .filter(({ length }) => length >= least && (most === 0 || length <= most))
        .sort((a, b) => (order === "number" ? a.number - b.number : b[order] - a[order]));
}

export function tagsOf(branches: readonly Branch[]): string[] {
    return [...new Set(branches.flatMap(({ tags }) => tags))].sort();
}

/** The options of compose that take the branches of a filter; words in names have none. */
export function filterValues({ tag, least, most }: Filter): Values {
    return {
        ...(tag ? { tag: [tag] } : {}),
        ...(least > 0 ? { least_length: [String(least)] } : {}),
        ...(most > 0 ? { most_length: [String(most)] } : {}),
    };
}

/** Where a key leads in a grid of so many columns; null where it is none of the grid's. */
export function stepInGrid(key: string, at: number, count: number, columns: number): number | null {
    const steps: Record<string, number> = {
        ArrowLeft: at - 1,
        ArrowRight: at + 1,
        ArrowUp: at - columns,
        ArrowDown: at + columns,
        Home: 0,
        End: count - 1,
        PageUp: at - 4 * columns,
        PageDown: at + 4 * columns,
    };
    return key in steps && count > 0 ? Math.min(Math.max(steps[key], 0), count - 1) : null;
}

/** A length for people: "3.2 m", "45 cm". */
export function lengthText(metres: number): string {
    return metres >= 1 ? `${Number(metres.toPrecision(3))} m` : `${Number((metres * 100).toPrecision(2))} cm`;
}
