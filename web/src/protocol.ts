// What page and server say to each other: docs/library/studio-protocol.md.

export type Kind = "solid" | "path" | "profile" | "points" | "skeleton" | "mesh";
export type Point = [number, number, number];

export interface ObjectName {
    kind: Kind;
    name: string;
}

export interface Statement {
    text: string; // as it stands in the document; blocks have several lines
    line: number; // of its first line in the whole text, from 1
    says: string; // what it said when it ran
}

export interface SceneObject extends ObjectName {
    version: number; // changes when the object does
    statement: number; // that made it last
    bounds: [number, number, number, number, number, number]; // [m] least, greatest
    count: number;
    unit: string; // of the count: "nodes"
}

export interface State {
    revision: number;
    by: string;
    statements: Statement[];
    ran: number;
    running: number | null; // statement, in the list that is being made
    doing: string; // its first line
    error: { statement: number; line: number; message: string } | null;
    objects: SceneObject[];
    undo: string[]; // the newest last
    redo: string[]; // the next one last
    file: string;
    saved: boolean;
    recovered: boolean; // the text was found in the journal of a studio that was killed
}

/** What growth has so far, while it runs. */
export interface Grown {
    statement: number;
    key: string; // of the skeleton's blob
    nodes: number;
    until: string; // the option with which the same command ends here: "max_iterations=57"
}

export type ErrorKind = "input" | "files" | "memory" | "cancelled" | "busy" | "internal";

export interface ArrayHeader {
    name: string;
    type: "f32" | "u32" | "u16" | "u8" | "i8";
    size: number;
    count: number;
    offset: number;
}

export interface GeometryHeader {
    kind: "surface" | "skeleton" | "points" | "curve" | "patch";
    object: ObjectName;
    version: number;
    origin: Point;
    arrays: ArrayHeader[];
    seq?: number; // of a preview
    color?: string; // what "value" stands for, as it was asked for
    low?: number; // of "value"
    high?: number;
    closed?: boolean; // of a curve
    base?: number; // of a patch
    ranges?: { vertices: [number, number][]; quads: [number, number][] };
    vertices?: number;
    quads?: number;
}

// Of a blob of kind "slice": samples of a solid's field on a plane, in the array "value", rows from the corner on.
export interface SliceHeader {
    width: number;
    height: number;
    corner: Point; // [m] from the origin
    along: Point; // over the whole width
    up: Point; // over the whole height
    level: number; // of the surface
    low: number;
    high: number;
}

// One command of the scene language, as `schema` gives it in "scene".
export interface Argument {
    name: string;
    help: string;
    type: "new_name" | "object" | "number" | "whole" | "flag" | "choice" | "tuple" | "section" | "word" | "input_file" | "selection"
        | "output_file" | "properties";
    positional: boolean;
    required: boolean;
    repeats: boolean;
    default?: string; // as typed; "@x": what argument x is
    unit?: string; // "metre"; angles have "degree" and are typed so
    low?: number;
    high?: number;
    choices?: string[];
    kind?: Kind; // of an object; "any" where it may be of every kind
    also?: Kind[]; // further kinds, where none of `kind` is called so
    sizes?: number[]; // how many numbers a tuple may have
}

export interface Command {
    name: string;
    aliases: string[];
    group: string;
    help: string;
    example: string;
    arguments: Argument[];
}
