// Finds the names of objects that statements create, change and use.
import type { Argument, Command, Kind, ObjectName } from "../protocol";
import { type Bound, bind, findCommand, kindsOf } from "./commands";
import { linesOf, piecesOf } from "./pieces";
import { isComputed, readLine, type Word } from "./words";

interface Place {
    from: number; // position of the name in the statement
    to: number;
    name: string;
    kinds: readonly Kind[]; // allowed kinds of the object; empty: any
    role: "makes" | "changes" | "uses";
}

// Commands that name objects without changing them.
const kOnlyLook = new Set(["describe", "delete", "edit select", "save", "save pointset", "render", "slice", "pointset quality"]);

/** The kind of the object that a new name refers to, if it is known; empty otherwise. */
export function newKind(argument: Argument): readonly Kind[] {
    const kind = /\bnew (solid|path|profile|points|skeleton|mesh|material)\b/.exec(argument.help)?.[1];
    return kind ? [kind as Kind] : [];
}

function narrowed(kinds: readonly Kind[], bound: readonly Bound[]): readonly Kind[] {
    const givenKind = bound.find(({ argument }) => argument.name === "kind" && argument.type === "choice")?.words[0].text;
    return givenKind && kinds.includes(givenKind as Kind) ? [givenKind as Kind] : kinds;
}

/** solid(crown): the nodes inside the solid. */
function placesInSelection(line: string, word: Word): Place[] {
    return [...line.slice(word.value, word.to).matchAll(/\bsolid\(\s*([A-Za-z_][\w.-]*)/g)].map((match) => {
        const to = word.value + match.index + match[0].length;
        return { from: to - match[1].length, to, name: match[1], kinds: ["solid"], role: "uses" };
    });
}

/** The argument that names the object a command changes; undefined for commands that create or only inspect objects. */
export function changedBy(command: Command): Argument | undefined {
    const makes = command.arguments.some(({ type }) => type === "new_name");
    return makes || kOnlyLook.has(command.name) ? undefined : command.arguments.find(({ type, positional }) => type === "object" && positional);
}

function placesInCommand(line: string, command: Command, bound: readonly Bound[]): Place[] {
    const changed = changedBy(command);
    const places: Place[] = [];
    for (const { argument, words } of bound) {
        const [word] = words;
        if (argument.type === "new_name") {
            places.push({ ...span(word), name: word.text, kinds: newKind(argument), role: "makes" });
        } else if (argument.type === "object") {
            const role = argument === changed ? "changes" : "uses";
            places.push({ ...span(word), name: word.text, kinds: narrowed(kindsOf(argument), bound), role });
        } else if (argument.type === "section") {
            const name = word.text.split("@")[0];
            places.push({ from: word.value, to: word.value + name.length, name, kinds: ["profile"], role: "uses" });
        } else if (argument.type === "selection") {
            places.push(...placesInSelection(line, word));
        }
    }
    return places;
}

function span(word: Word): { from: number; to: number } {
    return { from: word.value, to: word.to };
}

/** Implied names: "that of SOLID". */
function impliedNames(command: Command, bound: readonly Bound[]): Place[] {
    return command.arguments
        .filter((argument) => argument.type === "new_name" && argument.default?.startsWith("@"))
        .filter((argument) => !bound.some((one) => one.argument === argument))
        .flatMap((argument) => {
            const other = bound.find((one) => one.argument.name === argument.default?.slice(1));
            return other ? [{ from: -1, to: -1, name: other.words[0].text, kinds: newKind(argument), role: "makes" as const }] : [];
        });
}

function placesInLet(line: string): Place[] {
    const match = /^\s*let\s+\w+\s*=\s*"([^"\\$]*)"/.exec(line);
    const from = match ? match[0].lastIndexOf('"', match[0].length - 2) + 1 : 0;
    return match ? [{ from, to: from + match[1].length, name: match[1], kinds: [], role: "uses" }] : [];
}

function readPlaces(schema: readonly Command[], statement: string): Place[] {
    return linesOf(statement).flatMap(({ text, from }) => {
        const { words } = readLine(text);
        const found = findCommand(schema, words);
        if (!found) {
            return placesInLet(text).map((place) => ({ ...place, from: place.from + from, to: place.to + from }));
        }
        const { bound } = bind(found.command, words.slice(found.used));
        const places = placesInCommand(text, found.command, bound).map((place) => ({ ...place, from: place.from + from, to: place.to + from }));
        return [...places, ...impliedNames(found.command, bound)].filter(({ name }) => !isComputed(name));
    });
}

function means(place: Place, object: ObjectName): boolean {
    return place.name === object.name && (place.kinds.length === 0 || place.kinds.includes(object.kind));
}

const kMaxKnown = 50_000; // number of cached statements
const kKnown = new WeakMap<readonly Command[], Map<string, readonly Place[]>>();

/** The names of objects in a statement and their positions, in the order of the text. Results are cached. */
export function placesIn(schema: readonly Command[], statement: string): readonly Place[] {
    let known = kKnown.get(schema);
    if (!known || known.size > kMaxKnown) {
        known = new Map();
        kKnown.set(schema, known);
    }
    const places = known.get(statement) ?? readPlaces(schema, statement);
    known.set(statement, places);
    return places;
}

/** The numbers of the statements that created and changed an object, up to and including `last`. */
export function stepsOf(schema: readonly Command[], statements: readonly { text: string }[], object: ObjectName, last: number): number[] {
    const steps: number[] = [];
    for (let i = Math.min(last, statements.length - 1); i >= 0; --i) {
        const mine = placesIn(schema, statements[i].text).filter((place) => place.role !== "uses" && means(place, object));
        if (i === last || mine.length > 0) {
            steps.unshift(i);
        }
        if (mine.some(({ role }) => role === "makes")) {
            break; // earlier states of the object have no influence
        }
    }
    return steps;
}

/** The skeleton from which this statement creates the mesh; null if the statement does not name it. */
export function meshSource(schema: readonly Command[], statement: string, mesh: string): string | null {
    const places = placesIn(schema, statement);
    const isMade = places.some((place) => place.role === "makes" && means(place, { kind: "mesh", name: mesh }));
    const used = new Set(places.filter(({ role, kinds }) => role === "uses" && kinds[0] === "skeleton").map(({ name }) => name));
    return isMade && used.size === 1 ? [...used][0] : null;
}

/** Renames all objects of a name in the text, and counts the occurrences. */
export function renamed(schema: readonly Command[], text: string, name: string, to: string): { text: string; lines: Set<number> } {
    let out = "";
    let done = 0;
    const lines = new Set<number>();
    piecesOf(text).forEach((piece, number) => {
        for (const place of placesIn(schema, piece.text)) {
            if (place.name === name && place.from >= 0) {
                out += text.slice(done, piece.from + place.from) + to;
                done = piece.from + place.to;
                lines.add(number);
            }
        }
    });
    return { text: out + text.slice(done), lines };
}

/** Returns whether a text is a valid name of an object: letters, digits, _, - and . after a letter or _. */
export function isObjectName(name: string): boolean {
    return /^[A-Za-z_][A-Za-z0-9_.-]{0,63}$/.test(name);
}
