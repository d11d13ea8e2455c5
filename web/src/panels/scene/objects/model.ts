// The objects of a scene as a tree: groups by kind, and below a solid its operands.
import type { Command, Kind, ObjectName, SceneObject, State } from "../../../protocol";
import { placesIn } from "../../../script/names";

export interface Row {
    id: string; // "solid", "solid:crown"
    label: string;
    detail: string; // "563 nodes"
    level: number; // from 1
    position: number; // among its siblings, from 1
    size: number; // number of siblings, including itself
    parent: string; // id; empty at the top
    open: boolean | null; // null: it has no children
    object: SceneObject | null; // null: a group
}

export const kGroups: readonly (readonly [Kind, string])[] = [
    ["solid", "Crown solids"],
    ["points", "Points"],
    ["skeleton", "Skeletons"],
    ["mesh", "Meshes"],
    ["material", "Materials"],
    ["profile", "Profiles"],
    ["path", "Paths"],
];

export function idOf({ kind, name }: ObjectName): string {
    return `${kind}:${name}`;
}

/** For each solid, the last other solid in which it was used. */
export function consumers(state: State, schema: readonly Command[]): Map<string, string> {
    const solids = new Set(state.objects.filter(({ kind }) => kind === "solid").map(({ name }) => name));
    const into = new Map<string, string>();
    state.statements.slice(0, state.ran).forEach(({ text }) => {
        const places = placesIn(schema, text).filter(({ kinds, name }) => (kinds.length === 0 || kinds.includes("solid")) && solids.has(name));
        const result = places.find(({ role, kinds }) => role === "makes" && kinds.includes("solid"));
        places
            .filter(({ role, name }) => result && role === "uses" && name !== result.name)
            .forEach(({ name }) => result && leadsTo(into, result.name, name) === false && into.set(name, result.name));
    });
    return into;
}

// Returns whether one is already an operand of the other: then the other cannot be its operand.
function leadsTo(into: ReadonlyMap<string, string>, part: string, whole: string): boolean {
    for (let at: string | undefined = part; at !== undefined; at = into.get(at)) {
        if (at === whole) {
            return true;
        }
    }
    return false;
}

function countText({ count, unit }: SceneObject): string {
    const word = count === 1 ? unit.replace(/s$/, "") : unit;
    return unit === "" ? "" : `${count.toLocaleString("en")} ${word}`;
}

/** The visible rows, from the top; `closed` are the ids of collapsed rows. */
export function rowsOf(state: State, schema: readonly Command[], closed: ReadonlySet<string>): Row[] {
    const into = consumers(state, schema);
    const partsOf = new Map<string, SceneObject[]>();
    for (const object of state.objects) {
        const whole = object.kind === "solid" ? into.get(object.name) : undefined;
        const parent = whole === undefined ? object.kind : idOf({ kind: "solid", name: whole });
        const parts = partsOf.get(parent) ?? [];
        parts.push(object);
        partsOf.set(parent, parts);
    }
    const rows: Row[] = [];
    const put = (parent: string, level: number) => {
        const objects = partsOf.get(parent) ?? [];
        objects.forEach((object, i) => {
            const id = idOf(object);
            const open = partsOf.has(id) ? !closed.has(id) : null;
            rows.push({ id, label: object.name, detail: countText(object), level, position: i + 1, size: objects.length, parent, open, object });
            if (open) {
                put(id, level + 1);
            }
        });
    };
    const groups = kGroups.filter(([kind]) => state.objects.some((object) => object.kind === kind));
    groups.forEach(([kind, label], i) => {
        const count = state.objects.filter((object) => object.kind === kind).length;
        const open = !closed.has(kind);
        rows.push({ id: kind, label, detail: String(count), level: 1, position: i + 1, size: groups.length, parent: "", open, object: null });
        if (open) {
            put(kind, 2);
        }
    });
    return rows;
}

/** The next row with this prefix, after the one at `from`; -1 if there is none. */
export function found(rows: readonly Row[], from: number, typed: string): number {
    const begins = ({ label }: Row) => label.toLowerCase().startsWith(typed.toLowerCase());
    for (let step = 1; step <= rows.length; ++step) {
        const at = (from + step) % rows.length;
        if (begins(rows[at])) {
            return at;
        }
    }
    return -1;
}
