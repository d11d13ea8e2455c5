// Keys of an animation and the moments of its frames: as docs/user/animating.md has them.
import type { Statement } from "../../../protocol";
import { readLine } from "../../../script/words";

export type Easing = "smooth" | "linear" | "in" | "out" | "hold";
export const kEasings: readonly (readonly [Easing, string])[] = [
    ["smooth", "starts and ends slowly"],
    ["linear", "at one speed"],
    ["in", "starts slowly"],
    ["out", "ends slowly"],
    ["hold", "stays, and jumps"],
];

export interface Key {
    time: number; // [s]
    easing: Easing; // of the way to it
    edits: string; // "rest", or edits with semicolons between them
}

export interface Film {
    tree: string; // name of the skeleton
    grow: boolean; // from the root up, instead of keys and wind
    keys: readonly Key[]; // by their times
    wind: Readonly<Record<"speed" | "azimuth" | "gusts" | "flexibility" | "load" | "seed", number>>;
    growing: { age: "length" | "order"; exponent: number };
    duration: number; // [s]
    rate: number; // frames a second
}

const kStep = 1e-3; // [s] to which times are written

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

/** Whether anything moves. */
export function moves(film: Film): boolean {
    return film.grow || isWindy(film) || film.keys.length > 0;
}

/** Of keys the last moment is shown too; of the wind it is the first again, and growth begins with its first step. */
export function frameCount(film: Film): number {
    return Math.round(film.duration * film.rate) + (film.grow || isWindy(film) ? 0 : 1);
}

/** The frame that is shown at a time; times behind the end are the last frame's. */
export function frameAt(film: Film, time: number): number {
    return Math.min(Math.max(Math.round(time * film.rate), 0), Math.max(frameCount(film) - 1, 0));
}

export function timeOf(film: Film, frame: number): number {
    return frame / film.rate;
}

/** To whole frames, and never two keys at one time: the place of the film nearest to `time` that none of the others has. */
export function freeTime(film: Film, time: number, but?: Key): number {
    const taken = new Set(film.keys.filter((key) => key !== but).map((key) => Math.round(key.time * film.rate)));
    const last = Math.round(film.duration * film.rate);
    const wanted = Math.min(Math.max(Math.round(time * film.rate), 0), last);
    const steps = Array.from({ length: last + 1 }, (_, step) => [wanted + step, wanted - step]).flat();
    const frame = steps.find((one) => one >= 0 && one <= last && !taken.has(one)) ?? wanted;
    return Math.round(timeOf(film, frame) / kStep) * kStep;
}

/** With a key more, or another one in place of it. */
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

/** The keys as a file of them. */
export function keysText(keys: readonly Key[]): string {
    return keys.map((key) => `${keyText(key)}\n`).join("");
}

/** Throws where a line is no key; what its edits do the engine tells. */
export function readKeys(text: string): Key[] {
    const keys: Key[] = [];
    text.split(/\r\n|\r|\n/).forEach((line, at) => {
        const plain = line.replace(/(^|\s)#.*/, "").trim();
        if (plain !== "") {
            const match = /^(\d+\.?\d*|\.\d+)(?:\s+(smooth|linear|in|out|hold))?\s*:\s*(.*)$/.exec(plain);
            if (!match) {
                throw new Error(`Line ${at + 1} is no key; keys read as "1.5 out: bend near(0,0,3) 20".`);
            }
            keys.push({ time: Number(match[1]), easing: (match[2] as Easing | undefined) ?? "smooth", edits: match[3] || "rest" });
        }
    });
    return keys.sort((a, b) => a.time - b.time);
}

/** The fields of `animate` and `frame` that say what moves. */
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

/** The last statement that only moves nodes of a skeleton, as a key says it; null where there is none, or one after it does more. */
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
