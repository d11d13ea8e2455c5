// The content of a file, by its extension, or by its first bytes if several kinds share one: the same rules as in the program.
import { endingOf } from "./folder";

export type Content = "skeleton" | "mesh" | "points" | "scene" | "sketch" | "library" | "photograph";

/** The reason why a file is refused, as a phrase after its name: "is ...". */
export class NotRead extends Error {}

const kHead = 64 * 1024;

const kByEnding: Record<string, Content> = {
    ".swc": "skeleton",
    ".mat": "skeleton",
    ".graph": "skeleton",
    ".gel": "skeleton",
    ".rsml": "skeleton",
    ".mtg": "skeleton",
    ".stl": "mesh",
    ".glb": "mesh",
    ".xyz": "points",
    ".asc": "points",
    ".pts": "points",
    ".ptx": "points",
    ".pcd": "points",
    ".las": "points",
    ".laz": "points",
    ".coppice": "scene",
    ".branches": "library",
    ".png": "photograph",
    ".jpg": "photograph",
    ".jpeg": "photograph",
};

const kNotRead: Record<string, string> = {
    ".e57": "is an E57 file, which is not supported; save it as LAZ, LAS or PLY, for example with CloudCompare",
    ".bin": "is a CloudCompare file, which is not supported; save it as LAZ, LAS or PLY",
    ".fbx": "is an FBX file, which is not supported; save it as GLB or OBJ, for example with Blender",
    ".blend": "is a Blender file, which is not supported; save it as GLB, OBJ or PLY",
    ".gltf": "is a glTF file with external files; save it as GLB, which is one file",
};

const kPacked = new Set([".zip", ".gz", ".7z", ".bz2", ".xz", ".zst", ".tar"]);

/** For the dialog in which files are chosen. */
export const kReadEndings: readonly string[] = [...Object.keys(kByEnding), ".obj", ".ply", ".off", ".txt", ".csv", ".json"];

/** Returns the content of a file. Throws NotRead. */
export async function contentOf(name: string, data: Blob): Promise<Content> {
    const ending = endingOf(name);
    const head = async () => new TextDecoder("latin1").decode(await data.slice(0, kHead).arrayBuffer());
    if (data.size === 0) {
        throw new NotRead("is empty");
    }
    switch (ending) {
        case ".ply":
            return plyContent(await head());
        case ".off":
            return offContent(await head());
        case ".obj":
            return (await holdsLines(data)) ? "skeleton" : "mesh";
        case ".txt":
        case ".csv":
            return isTree(await head()) ? "skeleton" : "points";
        case ".sketch.json":
            return "sketch";
        case ".json":
            return jsonContent(await head());
    }
    if (ending in kByEnding) {
        return kByEnding[ending];
    }
    throw new NotRead(kNotRead[ending] ?? (kPacked.has(ending) ? "is compressed; unpack it first" : "is not in a supported format"));
}

export function plyContent(head: string): Content {
    const header = head.slice(0, Math.max(head.indexOf("end_header"), 0) || head.length);
    const has = (element: string) => new RegExp(`^element ${element} +[1-9]`, "m").test(header);
    if (!header.startsWith("ply")) {
        throw new NotRead("is not a PLY file, although its name ends so");
    }
    if (has("face") || has("tristrips") || !has("vertex")) {
        return "mesh";
    }
    return has("edge") ? "skeleton" : "points";
}

/** The second number of an OFF file is its number of faces. */
export function offContent(head: string): Content {
    const words = head
        .replace(/#.*/g, "")
        .split(/\s+/)
        .filter((word) => /^\d+$/.test(word));
    return words.length >= 2 && Number(words[1]) === 0 ? "points" : "mesh";
}

/** Returns whether the first element of an OBJ file is a line and not a face: long lists of vertices may precede it. */
async function holdsLines(data: Blob): Promise<boolean> {
    const kChunk = 1 << 22;
    for (let at = 0; at < data.size; at += kChunk) {
        const chunk = data.slice(Math.max(at - 2, 0), at + kChunk); // overlaps by two bytes, so that a keyword at the border is found
        const found = /(?:^|[\r\n])([fl])[ \t]/.exec(new TextDecoder("latin1").decode(await chunk.arrayBuffer()));
        if (found) {
            return found[1] === "l";
        }
    }
    return false;
}

function jsonContent(head: string): Content {
    if (head.includes('"coppice-sketch"')) {
        return "sketch";
    }
    if (head.includes('"parent"') || head.includes('"coppice-skeleton"')) {
        return "skeleton";
    }
    throw new NotRead("is JSON of another program; only skeletons and sketches of Coppice are supported");
}

/**
 * Returns whether a text is a tree and not points: a table of cylinders, raycloudtools or SWC, by column names or by the
 * structure of the numbers.
 */
export function isTree(head: string): boolean {
    const whole = head.length < kHead ? head : head.slice(0, head.lastIndexOf("\n"));
    const lines = whole
        .replace(/^\uFEFF|^ï»¿/, "")
        .split(/\r\n|\r|\n/)
        .filter((line) => line.trim() !== "" && !/^\s*(#|\/\/)/.test(line));
    if (lines.length === 0) {
        return false;
    }
    const first = numbers(lines[0]);
    return first ? isCylinder(first) || areNodes(lines.slice(0, 100).map(numbers)) : isTreeHeader(lines[0]);
}

function numbers(line: string): number[] | null {
    const values = line
        .trim()
        .split(/[\s,;]+/)
        .map(Number);
    return values.every(Number.isFinite) ? values : null;
}

function isTreeHeader(line: string): boolean {
    const names = line
        .toLowerCase()
        .split(/[,;\t]|\s{1,}/)
        .map((name) => name.replace(/[_ "']|\(.*?\)|\[.*?\]/g, ""))
        .filter(Boolean);
    const radius = names.some((name) => ["radius", "radiuscyl", "cylradius", "rad"].includes(name));
    const start = names.some((name) => /^(startx|sx|startpointx|startpoint|start)$/.test(name));
    return (radius && start) || /(^|,)x,y,z,radius(,|$)/.test(line.trim());
}

/** A row of the table of TreeQSM: radius, length, start, unit axis, parent, extension. */
function isCylinder(row: readonly number[]): boolean {
    const axis = Math.hypot(row[5], row[6], row[7]);
    return row.length >= 10 && row[0] > 0 && row[1] >= 0 && Math.abs(axis - 1) < 0.05 && Number.isInteger(row[8]) && Number.isInteger(row[9]);
}

/** Rows of SWC: an id, a type, a position, a radius, and the id of another row or -1. */
function areNodes(rows: readonly (readonly number[] | null)[]): boolean {
    const kColumns = 7;
    const cut = rows.findIndex((row) => row?.length !== kColumns);
    const nodes = (cut < 0 ? rows : rows.slice(0, cut)) as readonly number[][];
    const ids = new Set(nodes.map((row) => row[0]));
    const fits = nodes.every(([id, type, , , , , parent]) => [id, type, parent].every(Number.isInteger) && id >= 0 && type >= 0 && id !== parent);
    const linked = nodes.filter((row) => row[6] === -1 || ids.has(row[6])).length;
    return nodes.length > 0 && fits && ids.size === nodes.length && 2 * linked >= nodes.length;
}
