// Files of the open folder: their names, and the confirmation before one is replaced.
import { type App, EngineError } from "../../app";
import { confirm } from "./dialog";

export interface FolderFile {
    name: string;
    bytes: number;
}

const kMaxLetters = 200;

/** The size in the largest unit with a value of at least 1: "12.3 MB". */
export function bytesText(bytes: number): string {
    const units = ["bytes", "KB", "MB", "GB"];
    let value = bytes;
    let unit = 0;
    while (value >= 1000 && unit < units.length - 1) {
        value /= 1000;
        ++unit;
    }
    return `${unit === 0 || value >= 100 ? Math.round(value) : value.toFixed(1)} ${units[unit]}`;
}

/** The file extension in lower case, ".ply"; double extensions that the program knows are kept. */
export function endingOf(name: string): string {
    const lower = name.toLowerCase();
    return lower.endsWith(".sketch.json") ? ".sketch.json" : (/\.[a-z0-9]+$/.exec(lower)?.[0] ?? "");
}

/** The name without its folders. */
export function baseOf(name: string): string {
    return name.slice(name.lastIndexOf("/") + 1);
}

export function stemOf(name: string): string {
    const base = baseOf(name);
    return base.slice(0, base.length - endingOf(base).length) || base;
}

export function withEnding(name: string, ending: string): string {
    return name === "" || endingOf(name) === ending ? name : name + ending;
}

/** The error in the name of a new file; empty if it is valid. */
export function nameError(name: string): string {
    if (name === "") {
        return "Give the file a name.";
    }
    if (name.startsWith("/") || /^[a-z]:/i.test(name) || name.includes("\\")) {
        return "Use a name in the open folder, with / between a subfolder and the file.";
    }
    if (name.split("/").some((part) => part === "" || part.startsWith("."))) {
        return "No component of the name may be empty or begin with a dot.";
    }
    if ([...name].some((letter) => letter < " ")) {
        return "The name contains invisible characters.";
    }
    return name.length > kMaxLetters ? `A name may have at most ${kMaxLetters} characters.` : "";
}

/** An unused name: oak.swc, oak-2.swc, ... */
export function freeFile(name: string, taken: ReadonlySet<string>): string {
    const ending = endingOf(name);
    const stem = name.slice(0, name.length - ending.length);
    let free = name;
    for (let n = 2; taken.has(free); ++n) {
        free = `${stem}-${n}${ending}`;
    }
    return free;
}

/** A name for an object, from the name of a file: letters, digits, _, - and . after a letter. */
export function objectName(file: string): string {
    const letters = stemOf(file).normalize("NFD").replace(/\p{M}/gu, ""); // without accents
    const plain = letters.replace(/[^A-Za-z0-9_.-]+/g, "_").replace(/^[^A-Za-z]+/, "");
    return plain.replace(/[_.-]+$/, "").slice(0, 60) || "object";
}

export async function listFiles(app: App, ending = ""): Promise<FolderFile[]> {
    return (await app.engine.request<{ files: FolderFile[] }>("files", { ending })).files;
}

/**
 * Writes a file. If it exists, the user has to confirm; null if the user declines. `written` are the names of the resulting
 * files, if they differ from the requested one.
 */
export async function writing<R>(app: App, name: string, write: (overwrite: boolean) => Promise<R>, written?: RegExp): Promise<R | null> {
    try {
        return await write(false);
    } catch (error) {
        const isThere = async () => (await listFiles(app)).some((file) => file.name === name || written?.test(file.name));
        if (!(error instanceof EngineError) || error.kind !== "files" || !(await isThere())) {
            throw error;
        }
        const text = `The folder already contains a file ${name}. Its current content would be lost.`;
        return (await confirm("Replace the file?", text, "Replace")) ? write(true) : null;
    }
}

/** Downloads a file of the folder with the browser. */
export async function download(app: App, name: string): Promise<void> {
    const url = URL.createObjectURL(await app.engine.file(name));
    const link = document.createElement("a");
    link.href = url;
    link.download = baseOf(name);
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
