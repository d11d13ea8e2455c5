// Lines of commands: words with quotes where they need them, numbers with no more digits than the hand has.
import type { Kind, ObjectName, Point } from "../../protocol";
import { isObjectName } from "../../script/names";

const kMostDigits = 9;

/** A number with so many digits that it is off by less than `step`. */
export function numberWord(value: number, step = 1e-4): string {
    if (!Number.isFinite(value)) {
        return "0";
    }
    const digits = Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), kMostDigits);
    const text = value.toFixed(digits);
    const short = text.includes(".") ? text.replace(/\.?0+$/, "") : text;
    return /^-?0?$/.test(short) ? "0" : short;
}

/** A number that is above 0 and stays so when it is rounded. */
export function sizeWord(value: number, step = 1e-4): string {
    const word = numberWord(value, step);
    return Number(word) > 0 ? word : numberWord(Math.max(value, 1e-9), Math.max(value, 1e-9) / 10);
}

export function pointWord(point: readonly number[], step = 1e-4): string {
    return point.map((value) => numberWord(value, step)).join(",");
}

/** A direction; its digits do not depend on how large the scene is. */
export function directionWord(direction: Point): string {
    return pointWord(direction, 1e-4);
}

const kNewName = /^\$\{new [\w.-]+\}$/;

/** The name of a new object in a line that is run or previewed: where an object has this name already the engine takes the next free one. */
export function newName(name: string): string {
    return isObjectName(name) ? `\${new ${name}}` : name;
}

/** A word as a scene reads it again: in quotes where it has blanks, quotes or the beginning of an option or a comment. */
export function quoted(text: string): string {
    if (kNewName.test(text)) {
        return text;
    }
    const safe = text.replaceAll("${", () => "$${");
    const plain = safe !== "" && !/^#|^[a-z0-9_]+=|[\s"\\]/.test(safe);
    return plain ? safe : `"${safe.replace(/["\\]/g, "\\$&")}"`;
}

export type OptionValue = string | number | boolean | undefined;

/** A line of words in order and options by name. Words are quoted as they need it; undefined options are left out, lists are repeated. */
export function commandLine(
    words: readonly (string | number)[],
    options: Record<string, OptionValue | readonly string[]> = {},
): string {
    const named = Object.entries(options)
        .flatMap(([name, value]) => (Array.isArray(value) ? value : [value]).map((one: OptionValue) => [name, one] as const))
        .filter(([, value]) => value !== undefined && value !== "")
        .map(([name, value]) => `${name}=${quoted(String(value))}`);
    const [command, ...rest] = words;
    return [String(command), ...rest.map((word) => quoted(String(word))), ...named].join(" ");
}

/** kind= where a name stands for several objects that a command could mean. */
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
