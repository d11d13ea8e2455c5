// The protocol between page and server: docs/library/studio-protocol.md.

export type Kind = "solid" | "path" | "profile" | "points" | "skeleton" | "mesh" | "material";
export type Point = [number, number, number];

export interface ObjectName {
    kind: Kind;
    name: string;
}

export interface Statement {
    text: string; // source text of the statement; blocks have several lines
    line: number; // number of its first line in the whole text, from 1
    message: string; // output of the statement
}

export interface SceneObject extends ObjectName {
    version: number; // changes when the object changes
    statement: number; // number of the statement that changed it last
    bounds: [number, number, number, number, number, number]; // [m] minimum, maximum; of objects without an extent, as materials, the minimum is larger
    count: number;
    unit: string; // unit of the count: "nodes"
}

export interface State {
    revision: number;
    by: string;
    statements: Statement[];
    ran: number;
    running: number | null; // index of the running statement in the new list
    doing: string; // its first line
    error: { statement: number; line: number; message: string } | null;
    objects: SceneObject[];
    undo: string[]; // in order, the newest last
    redo: string[]; // in order, the next one last
    file: string;
    saved: boolean;
    recovered: boolean; // the text was recovered from the journal of a studio that was killed
}

/** Intermediate result of a growth. */
export interface Grown {
    statement: number;
    key: string; // key of the blob of the skeleton
    nodes: number;
    until: string; // the option with which the same command stops at this state: "max_iterations=57"
}

export type ErrorKind = "input" | "files" | "memory" | "cancelled" | "busy" | "internal";

export interface ArrayHeader {
    name: string;
    type: "f32" | "u32" | "u16" | "u8" | "i8";
    size: number;
    count: number;
    offset: number;
}

/** Keys of the blobs with the images of a material. */
export type ImageKeys = Partial<Record<"color" | "normal" | "roughness" | "occlusion", string>>;

export interface GeometryHeader {
    kind: "surface" | "skeleton" | "points" | "curve" | "patch";
    object: ObjectName;
    version: number;
    origin: Point;
    arrays: ArrayHeader[];
    seq?: number; // number of the preview
    color?: string; // quantity in "value", as requested
    slots?: number[]; // number of quads, or triangles, of each material, in their order; without it, all have the first
    images?: ImageKeys[]; // of a frame of a film, from the reply: by slot
    low?: number; // range of "value"
    high?: number;
    closed?: boolean; // of a curve
    base?: number; // of a patch
    ranges?: { vertices: [number, number][]; quads: [number, number][] };
    vertices?: number;
    quads?: number;
}

// Header of a blob of kind "slice": samples of the field of a solid on a plane, in the array "value", rows from the corner.
export interface SliceHeader {
    width: number;
    height: number;
    corner: Point; // [m] relative to the origin
    along: Point; // over the full width
    up: Point; // over the full height
    level: number; // iso value of the surface
    low: number;
    high: number;
}

// One argument of a command of the scene language, as returned by `schema` in "scene".
export interface Argument {
    name: string;
    help: string;
    type:
        | "new_name"
        | "object"
        | "number"
        | "whole"
        | "flag"
        | "choice"
        | "tuple"
        | "section"
        | "word"
        | "input_file"
        | "selection"
        | "output_file"
        | "properties";
    positional: boolean;
    required: boolean;
    repeats: boolean;
    default?: string; // as typed; "@x": the value of argument x
    unit?: string; // "metre"; angles have "degree" and are typed in degrees
    low?: number;
    high?: number;
    choices?: string[];
    kind?: Kind; // of an object; "any" if every kind is accepted
    also?: Kind[]; // further kinds, if no object of `kind` has the name
    sizes?: number[]; // allowed numbers of components of a tuple
}

export interface Command {
    name: string;
    aliases: string[];
    group: string;
    help: string;
    example: string;
    arguments: Argument[];
}
