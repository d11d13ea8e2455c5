// Filter and order of the branches of a library, and navigation by arrow keys.
import type { Values } from "../../script/values";

/** As in the response to the request `library`. */
export interface Branch {
    number: number;
    source: string;
    tags: string[];
    leads: boolean; // it continues the axis of its parent branch
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
    tag: string; // all if empty
    least: number; // [m] of length
    most: number; // 0: no limit
}

export const kAll: Filter = { text: "", tag: "", least: 0, most: 0 };
export type Order = "number" | "length" | "tips";

export function filtered(branches: readonly Branch[], { text, tag, least, most }: Filter, order: Order): Branch[] {
    const words = text.trim().toLowerCase();
    const matches = (branch: Branch) => [String(branch.number), branch.source, ...branch.tags].some((word) => word.toLowerCase().includes(words));
    return branches
        .filter((branch) => (words === "" || matches(branch)) && (tag === "" || branch.tags.includes(tag)))
        .filter(({ length }) => length >= least && (most === 0 || length <= most))
        .sort((a, b) => (order === "number" ? a.number - b.number : b[order] - a[order]));
}

export function tagsOf(branches: readonly Branch[]): string[] {
    return [...new Set(branches.flatMap(({ tags }) => tags))].sort();
}

/** The options of compose for the branches of a filter; a search text has no option. */
export function filterValues({ tag, least, most }: Filter): Values {
    return {
        ...(tag ? { tag: [tag] } : {}),
        ...(least > 0 ? { min_tree_length: [String(least)] } : {}),
        ...(most > 0 ? { max_tree_length: [String(most)] } : {}),
    };
}

/** The index after a key in a grid with this number of columns; null if the grid does not use the key. */
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

/** A length as text: "3.2 m", "45 cm". */
export function lengthText(metres: number): string {
    return metres >= 1 ? `${Number(metres.toPrecision(3))} m` : `${Number((metres * 100).toPrecision(2))} cm`;
}
