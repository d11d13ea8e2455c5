// Lines of commands: words are quoted if necessary, and numbers have the digits of their resolution.
import type { Kind, ObjectName, Point } from "../../protocol";
import { isObjectName } from "../../script/names";

const kMaxDigits = 9;

/** A number rounded with an error below `step`. */
export function numberWord(value: number, step = 1e-4): string {
    if (!Number.isFinite(value)) {
        return "0";
    }
    const digits = Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), kMaxDigits);
    const text = value.toFixed(digits);
    const short = text.includes(".") ? text.replace(/\.?0+$/, "") : text;
    return /^-?0?$/.test(short) ? "0" : short;
}

/** A positive number that remains positive when it is rounded. */
export function sizeWord(value: number, step = 1e-4): string {
    const word = numberWord(value, step);
    return Number(word) > 0 ? word : numberWord(Math.max(value, 1e-9), Math.max(value, 1e-9) / 10);
}

export function pointWord(point: readonly number[], step = 1e-4): string {
    return point.map((value) => numberWord(value, step)).join(",");
}

/** A direction; its digits do not depend on the size of the scene. */
export function directionWord(direction: Point): string {
    return pointWord(direction, 1e-4);
}

const kNewName = /^\$\{new [\w.-]+\}$/;

/**
 * The name of a new object in a line that is run or previewed: if an object has this name already, the engine uses the next free
 * one.
 */
export function newName(name: string): string {
    return isObjectName(name) ? `\${new ${name}}` : name;
}

/** A word as a scene can read it: quoted if it has blanks, quotes or the start of an option or a comment. */
export function quoted(text: string): string {
    if (kNewName.test(text)) {
        return text;
    }
    const safe = text.replaceAll("${", () => "$${");
    const plain = safe !== "" && !/^#|^[a-z0-9_]+=|[\s"\\]/.test(safe);
    return plain ? safe : `"${safe.replace(/["\\]/g, "\\$&")}"`;
}

export type OptionValue = string | number | boolean | undefined;

/**
 * A line of positional words and named options. Words are quoted if necessary; undefined options are omitted, lists are repeated.
 */
export function commandLine(words: readonly (string | number)[], options: Record<string, OptionValue | readonly string[]> = {}): string {
    const named = Object.entries(options)
        .flatMap(([name, value]) => (Array.isArray(value) ? value : [value]).map((one: OptionValue) => [name, one] as const))
        .filter(([, value]) => value !== undefined && value !== "")
        .map(([name, value]) => `${name}=${quoted(String(value))}`);
    const [command, ...rest] = words;
    return [String(command), ...rest.map((word) => quoted(String(word))), ...named].join(" ");
}

/** kind= if a name belongs to several objects that the command accepts. */
export function kindOption(objects: readonly ObjectName[], object: ObjectName, kinds: readonly Kind[]): { kind?: Kind } {
    const same = objects.filter((other) => other.name === object.name && kinds.includes(other.kind));
    return same.length > 1 ? { kind: object.kind } : {};
}

/** A selection of nodes by ids: "12", "id(3,40-50)". */
export function idSelection(ids: readonly number[]): string {
    const sorted = [...new Set(ids)].sort((a, b) => a - b);
    if (sorted.length === 1) {
        return String(sorted[0]);
    }
    const parts: string[] = [];
    for (let i = 0; i < sorted.length;) {
        let last = i;
        while (last + 1 < sorted.length && sorted[last + 1] === sorted[last] + 1) {
            ++last;
        }
        parts.push(last > i ? `${sorted[i]}-${sorted[last]}` : String(sorted[i]));
        i = last + 1;
    }
    return `id(${parts.join(",")})`;
}
