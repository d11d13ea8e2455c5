// Moving, rotating and scaling: from a drag or typed numbers to a change, and from a change to a line.
import type { App, Ray } from "../../app";
import type { ObjectName, Point, SceneObject } from "../../protocol";
import { anchored } from "./naming";
import { type Extent, skeletonOf } from "./skeleton";
import { type TypedInput, typedShift } from "./typed_input";
import { angleAbout, cross, dot, kAxes, length, onPlane, snapped, subtract } from "./vector";
import { commandLine, directionWord, idSelection, kindOption, numberWord, pointWord, sizeWord } from "./words";

export type Mode = "move" | "turn" | "size";
export type Change = { mode: "move"; by: Point } | { mode: "turn"; axis: Point; degrees: number } | { mode: "size"; factors: Point };

/** The changed object or nodes, and the line for a change. */
export interface Target {
    about: ObjectName;
    pivot: Point;
    label: string;
    evenly: boolean; // uniform scale only
    line(change: Change, step: number): string;
    final(change: Change, step: number): Promise<string>; // the line to store in the document
}

const kFactorStep = 1e-3;
const kDegreeStep = 1e-2;

export function isNothing(change: Change): boolean {
    switch (change.mode) {
        case "move":
            return length(change.by) === 0;
        case "turn":
            return change.degrees === 0;
        case "size":
            return change.factors.every((factor) => factor === 1);
    }
}

function factorsWord(factors: Point): string {
    const words = factors.map((factor) => numberWord(factor, kFactorStep));
    const safe = words.map((word) => (Number(word) === 0 ? "0.001" : word)); // a scale of 0 is refused
    return safe.every((word) => word === safe[0]) ? safe[0] : safe.join(",");
}

/** Translate, rotate or scale of a whole solid or skeleton. */
export function objectLine(app: Pick<App, "store">, object: ObjectName, change: Change, pivot: Point, step: number): string {
    const kind = kindOption(app.store.state.peek().objects, object, ["solid", "skeleton"]);
    switch (change.mode) {
        case "move":
            return commandLine(["translate", object.name, ...change.by.map((value) => numberWord(value, step))], kind);
        case "turn": {
            const axis = directionWord(change.axis);
            const options = { axis: axis === "0,0,1" ? undefined : axis, center: pointWord(pivot, step), ...kind };
            return commandLine(["rotate", object.name, numberWord(change.degrees, kDegreeStep)], options);
        }
        case "size":
            return commandLine(["scale", object.name, factorsWord(change.factors)], { center: pointWord(pivot, step), ...kind });
    }
}

/** Edit translate, rotate or scale of branches; edit move of one node. */
export function branchLine(tree: string, selection: string, alone: boolean, change: Change, step: number): string {
    switch (change.mode) {
        case "move":
            return alone
                ? commandLine(["edit", "move", tree, selection], { by: pointWord(change.by, step) })
                : commandLine(["edit", "translate", tree, selection, ...change.by.map((value) => numberWord(value, step))]);
        case "turn":
            return commandLine(["edit", "rotate", tree, selection, numberWord(change.degrees, kDegreeStep)], {
                axis: directionWord(change.axis),
            });
        case "size":
            return commandLine(["edit", "scale", tree, selection, sizeWord(change.factors[0], kFactorStep)]);
    }
}

function middle(object: SceneObject): Point {
    const [x0, y0, z0, x1, y1, z1] = object.bounds;
    return [(x0 + x1) / 2, (y0 + y1) / 2, object.kind === "skeleton" ? z0 : (z0 + z1) / 2];
}

function branchTarget(app: App, object: ObjectName, ids: readonly number[], extent: Extent): Target | null {
    const skeleton = skeletonOf(app, object.name);
    const nodes = skeleton?.selected(ids, extent) ?? [];
    if (!skeleton || nodes.length === 0) {
        return null;
    }
    const tops = skeleton.highest(nodes);
    const single = extent === "node" && nodes.length === 1;
    const parent = skeleton.parent(tops[0]);
    const topIds = tops.map((n) => skeleton.ids[n]);
    return {
        about: object,
        pivot: skeleton.at(single || parent < 0 ? tops[0] : parent),
        label: single ? `node ${topIds[0]}` : tops.length === 1 ? `the branch of node ${topIds[0]}` : `${tops.length} branches`,
        evenly: true,
        line: (change, step) => branchLine(object.name, idSelection(topIds), single, change, step),
        final: async (change, step) => branchLine(object.name, await anchored(app, object.name, topIds), single, change, step),
    };
}

/** The selection, if it can be moved: a solid, a skeleton, or branches of a skeleton. */
export function selectedTarget(app: App): Target | null {
    const { object, nodes, extent } = app.store.selection.peek();
    const found = object && app.store.find(object.kind, object.name);
    if (!object || !found || (object.kind !== "solid" && object.kind !== "skeleton")) {
        return null;
    }
    if (object.kind === "skeleton" && nodes.length > 0) {
        return branchTarget(app, object, nodes, extent);
    }
    const pivot = middle(found);
    const line = (change: Change, step: number) => objectLine(app, object, change, pivot, step);
    return {
        about: object,
        pivot,
        label: `${object.kind} ${object.name}`,
        evenly: false,
        line,
        final: (change, step) => Promise.resolve(line(change, step)),
    };
}

/** A drag of a handle or of the view, before axes, snapping and typed numbers are applied. */
export interface Dragged {
    by: Point; // [m] across the line of sight, or along the handle
    turn: number; // [degrees] about the active axis, or about the line of sight, counter-clockwise
    factor: number;
}

export interface Reading {
    mode: Mode;
    typed: TypedInput;
    evenly: boolean;
    sight: Point; // into the view
    snap: boolean;
    grid: number; // [m] of snapping
}

const kFacing = 0.25; // minimum cosine at which a ring is treated as facing the camera, and not as edge-on

/** [degrees] rotation about an axis for a drag from one line of sight to another; `radius` is the radius of the active ring. */
export function turnAbout(axis: Point, pivot: Point, from: Ray, to: Ray, sight: Point, radius: number): number {
    const [before, now] = [from, to].map((ray) => onPlane(ray, pivot, axis));
    if (before && now && Math.abs(dot(axis, sight)) > kFacing) {
        return (angleAbout(subtract(before, pivot), subtract(now, pivot), axis) * 180) / Math.PI;
    }
    const [left, right] = [from, to].map((ray) => onPlane(ray, pivot, sight));
    const along = cross(sight, axis); // direction of the near side of the ring
    return left && right && radius > 0 ? (dot(subtract(right, left), along) / radius / Math.PI) * 180 : 0;
}

const kTurnGrid = 5; // [degrees]
const kFactorGrid = 0.1;

/** The change of a drag and typed text. Typed text has priority. */
export function changeOf(dragged: Dragged, { mode, typed, evenly, sight, snap, grid }: Reading): Change {
    if (mode === "move") {
        const free = typed.constrain(dragged.by);
        const by: Point = snap ? [snapped(free[0], grid), snapped(free[1], grid), snapped(free[2], grid)] : free;
        return { mode, by: typedShift(typed) ?? by };
    }
    const values = typed.values();
    if (mode === "turn") {
        const axis: Point = typed.axis ? kAxes[typed.axis] : [-sight[0], -sight[1], -sight[2]];
        const degrees = values?.[0] ?? (snap ? snapped(dragged.turn, kTurnGrid) : dragged.turn);
        return { mode, axis, degrees };
    }
    const free = snap ? snapped(dragged.factor, kFactorGrid) : dragged.factor;
    return { mode, factors: factorsOf(values, free, typed, evenly) };
}

function factorsOf(values: number[] | null, free: number, typed: TypedInput, evenly: boolean): Point {
    if (values && values.length === 3 && !evenly) {
        return [values[0], values[1], values[2]];
    }
    const factor = values?.[0] ?? free;
    if (evenly || !typed.axis) {
        return [factor, factor, factor];
    }
    const axis = "xyz".indexOf(typed.axis);
    return [0, 1, 2].map((i) => ((i === axis) !== typed.plane ? factor : 1)) as Point;
}

/** Text for the status line. */
export function changeText(change: Change, step: number): string {
    switch (change.mode) {
        case "move":
            return `by ${pointWord(change.by, step).replaceAll(",", ", ")} m`;
        case "turn":
            return `by ${numberWord(change.degrees, 0.1)}°`;
        case "size":
            return `times ${factorsWord(change.factors).replaceAll(",", ", ")}`;
    }
}
