// Keys of an animation and times of its frames: docs/user/animating.md.
import type { Statement } from "../../../protocol";
import { readLine } from "../../../script/words";

export type Easing = "smooth" | "linear" | "in" | "out" | "hold";
export const kEasings: readonly (readonly [Easing, string])[] = [
    ["smooth", "starts and ends slowly"],
    ["linear", "at constant speed"],
    ["in", "starts slowly"],
    ["out", "ends slowly"],
    ["hold", "holds, then jumps"],
];

export interface Key {
    time: number; // [s]
    easing: Easing; // of the transition to it
    edits: string; // "rest", or edits separated by semicolons
}

export interface Film {
    tree: string; // name of the skeleton
    grow: boolean; // from the root up, instead of keys and wind
    keys: readonly Key[]; // sorted by time
    wind: Readonly<Record<"speed" | "azimuth" | "gusts" | "flexibility" | "load" | "seed", number>>;
    growing: { age: "length" | "order"; exponent: number };
    duration: number; // [s]
    rate: number; // frames per second
}

const kStep = 1e-3; // [s] resolution of times in files

export const kFirstFilm: Film = {
    tree: "",
    grow: false,
    keys: [],
    wind: { speed: 8, azimuth: 0, gusts: 0.5, flexibility: 1, load: 12, seed: 0 },
    growing: { age: "length", exponent: 2.5 },
    duration: 4,
    rate: 24,
};

export function isWindy(film: Film): boolean {
    return !film.grow && film.wind.speed > 0;
}

/** Returns whether the film contains any motion. */
export function moves(film: Film): boolean {
    return film.grow || isWindy(film) || film.keys.length > 0;
}

/** With keys the last frame is at the end; with wind the end equals the first frame, and growth begins with its first step. */
export function frameCount(film: Film): number {
    return Math.round(film.duration * film.rate) + (film.grow || isWindy(film) ? 0 : 1);
}

/** The frame at a time; times after the end have the last frame. */
export function frameAt(film: Film, time: number): number {
    return Math.min(Math.max(Math.round(time * film.rate), 0), Math.max(frameCount(film) - 1, 0));
}

export function timeOf(film: Film, frame: number): number {
    return frame / film.rate;
}

/** Rounds to whole frames with one key at most per frame: the time closest to `time` that no other key has. */
export function freeTime(film: Film, time: number, but?: Key): number {
    const taken = new Set(film.keys.filter((key) => key !== but).map((key) => Math.round(key.time * film.rate)));
    const last = Math.round(film.duration * film.rate);
    const wanted = Math.min(Math.max(Math.round(time * film.rate), 0), last);
    const steps = Array.from({ length: last + 1 }, (_, step) => [wanted + step, wanted - step]).flat();
    const frame = steps.find((one) => one >= 0 && one <= last && !taken.has(one)) ?? wanted;
    return Math.round(timeOf(film, frame) / kStep) * kStep;
}

/** Adds a key, or replaces one. */
export function withKey(film: Film, key: Key, before?: Key): Film {
    const others = film.keys.filter((one) => one !== before);
    return { ...film, keys: [...others, key].sort((a, b) => a.time - b.time) };
}

export function withoutKey(film: Film, key: Key): Film {
    return { ...film, keys: film.keys.filter((one) => one !== key) };
}

function timeWord(time: number): string {
    return String(Number(time.toFixed(3)));
}

export function keyText({ time, easing, edits }: Key): string {
    return `${timeWord(time)}${easing === "smooth" ? "" : ` ${easing}`}: ${edits.trim() || "rest"}`;
}

/** The keys in the file format for keys. */
export function keysText(keys: readonly Key[]): string {
    return keys.map((key) => `${keyText(key)}\n`).join("");
}

/** Throws if a line is not a key; the engine checks the edits. */
export function readKeys(text: string): Key[] {
    const keys: Key[] = [];
    text.split(/\r\n|\r|\n/).forEach((line, at) => {
        const plain = line.replace(/(^|\s)#.*/, "").trim();
        if (plain !== "") {
            const match = /^(\d+\.?\d*|\.\d+)(?:\s+(smooth|linear|in|out|hold))?\s*:\s*(.*)$/.exec(plain);
            if (!match) {
                throw new Error(`Line ${at + 1} is not a key; keys have the form "1.5 out: bend near(0,0,3) 20".`);
            }
            keys.push({ time: Number(match[1]), easing: (match[2] as Easing | undefined) ?? "smooth", edits: match[3] || "rest" });
        }
    });
    return keys.sort((a, b) => a.time - b.time);
}

/** The fields of `animate` and `frame` for the motion. */
export function motionFields(film: Film): { name: string; keys: string; options: Record<string, number | string | boolean> } {
    const options: Record<string, number | string | boolean> = { duration: film.duration, rate: film.rate };
    if (film.grow) {
        Object.assign(options, { grow: true, grow_age: film.growing.age, grow_exponent: film.growing.exponent });
    } else if (isWindy(film)) {
        Object.entries(film.wind).forEach(([name, value]) => {
            options[`wind_${name}`] = value;
        });
    }
    return { name: film.tree, keys: film.grow ? "" : keysText(film.keys), options };
}

const kRebuild = new Set(["select", "split", "detach", "delete", "prune", "resample", "draw", "append", "graft", "attach", "apart"]);

/**
 * The last statement, if it only moves nodes of a skeleton, in the form of a key; null if there is no such statement, or a later
 * one changes the tree in another way.
 */
export function lastEdit(statements: readonly Statement[], tree: string): { statement: number; edits: string } | null {
    for (let at = statements.length - 1; at >= 0; --at) {
        const { text } = statements[at];
        const { words } = readLine(text);
        const name = words.find(({ key }, n) => n >= 2 && (key === "tree" || key === ""));
        if (!text.includes("\n") && words[0]?.text === "edit" && name?.text === tree) {
            const rest = words.slice(1).filter((word) => word !== name);
            return kRebuild.has(words[1].text) ? null : { statement: at, edits: rest.map(({ from, to }) => text.slice(from, to)).join(" ") };
        }
    }
    return null;
}
