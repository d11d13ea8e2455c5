// Output formats, and the data of each kind of object that they store.
import type { Kind } from "../../protocol";

export type Holds = "surface" | "skeleton" | "points";

export interface Format {
    id: string; // "surface.ply": PLY is used for surfaces, skeletons and points
    holds: Holds;
    ending: string;
    label: string;
}

function format(holds: Holds, ending: string, label: string): Format {
    return { id: holds + ending, holds, ending, label };
}

export const kFormats: readonly Format[] = [
    format("surface", ".glb", "GLB: triangles, for games, the web and most programs"),
    format("surface", ".ply", "PLY: quads, exact"),
    format("surface", ".obj", "OBJ: quads, for modelling"),
    format("surface", ".stl", "STL: triangles, for printing"),
    format("surface", ".usda", "USD: quads, for film"),
    format("skeleton", ".swc", "SWC: nodes with radii"),
    format("skeleton", ".json", "JSON: the native format, with all data"),
    format("skeleton", ".obj", "OBJ: lines"),
    format("skeleton", ".ply", "PLY: vertices and edges"),
    format("skeleton", ".csv", "CSV: a table of cylinders"),
    format("skeleton", ".rsml", "RSML: a root system"),
    format("skeleton", ".mtg", "MTG: for OpenAlea"),
    format("points", ".xyz", "XYZ: text"),
    format("points", ".ply", "PLY: binary"),
];

const kHolds: Record<Kind, readonly Holds[]> = {
    solid: ["surface"],
    skeleton: ["surface", "skeleton"],
    mesh: ["surface"],
    points: ["points"],
    path: [],
    profile: [],
    material: [],
};

/** Returns whether objects of a kind can be written. */
export function isWritten(kind: Kind): boolean {
    return kHolds[kind].length > 0;
}

/** The formats that can store objects of all of these kinds. */
export function formatsOf(kinds: readonly Kind[]): readonly Format[] {
    return kFormats.filter(({ holds }) => kinds.every((kind) => kHolds[kind].includes(holds)));
}

export const kHoldsLabels: Record<Holds, string> = { surface: "Surfaces", skeleton: "Skeletons", points: "Points" };
