// A sketch as described in docs/user/sketching.md, and its edits. Values are immutable: each edit returns a new one.
import { simplified, toSegment } from "../tools/kit/vector";

export type Pixel = readonly [number, number];
export type Side = "front" | "back" | "side" | "left" | "top";

export interface SketchView {
    name: string;
    image?: string;
    width?: number;
    height?: number;
    orthographic?: Side;
    pixels_per_metre?: number;
    origin?: Pixel;
    photograph?: Exclude<Side, "top">;
    field_of_view?: number;
    colmap?: string;
    phenomenal?: string;
    camera?: string;
    angle?: number;
    K?: number[][];
    R?: number[][];
    rvec?: number[];
    t?: number[];
    distortion?: number[];
    projection?: "perspective" | "orthographic";
}

export interface Stroke {
    points: readonly Pixel[];
    widths?: readonly number[]; // [px] diameter of the branch, at every point or at both ends
}

export interface Branch {
    name: string;
    parent?: string;
    attach?: number;
    diameters?: readonly number[];
    strokes: Readonly<Record<string, Stroke>>; // by name of the view
}

export interface Sketch {
    format: "coppice-sketch";
    version: 1;
    height?: number;
    world?: { up?: number[]; metres_per_unit?: number };
    views: readonly SketchView[];
    branches: readonly Branch[];
}

const kNearParent = 40; // [px] maximum distance from an axis at which a stroke starts as a child of it

export function emptySketch(): Sketch {
    const view = (name: string, side: Side): SketchView => ({
        name,
        orthographic: side,
        pixels_per_metre: 100,
        origin: [400, 700],
        width: 800,
        height: 800,
    });
    return { format: "coppice-sketch", version: 1, views: [view("front", "front"), view("side", "side")], branches: [] };
}

/** Throws if the text is not a sketch. */
export function readSketch(text: string): Sketch {
    const read = JSON.parse(text) as Partial<Sketch> | null;
    if (read?.format !== "coppice-sketch" || !Array.isArray(read.views)) {
        throw new Error('The file is no sketch: its "format" is not "coppice-sketch".');
    }
    return { ...(read as Sketch), branches: read.branches ?? [] };
}

/**
 * Converts the sketch to the form that the engine reads: without branches that have no strokes, and without references to them.
 */
export function writtenSketch(sketch: Sketch): Sketch {
    const branches = sketch.branches.filter(({ strokes }) => Object.keys(strokes).length > 0);
    const names = new Set(branches.map(({ name }) => name));
    const kept = branches.map(({ parent, ...rest }) => (parent !== undefined && names.has(parent) ? { ...rest, parent } : rest));
    const { branches: _, ...head } = sketch;
    return kept.length > 0 ? { ...head, branches: kept } : (head as Sketch);
}

/** Returns whether a branch has strokes in two views. */
export function canReconstruct(sketch: Sketch): boolean {
    return sketch.branches.some(({ strokes }) => Object.keys(strokes).length >= 2);
}

/** Returns whether a branch has strokes in all views. */
export function isComplete(sketch: Sketch, name: string): boolean {
    const strokes = branchCalled(sketch, name)?.strokes ?? {};
    return sketch.views.every((view) => strokes[view.name]);
}

export const branchCalled = (sketch: Sketch, name: string): Branch | undefined => sketch.branches.find((branch) => branch.name === name);

export function freeBranch(sketch: Sketch): string {
    if (sketch.branches.length === 0) {
        return "stem";
    }
    let n = sketch.branches.length;
    while (branchCalled(sketch, `branch ${n}`)) {
        ++n;
    }
    return `branch ${n}`;
}

/** Returns the width of a stroke at one of its points. */
export function widthAt(stroke: Stroke, i: number): number {
    const { widths, points } = stroke;
    if (!widths || widths.length === 0) {
        return 6;
    }
    if (widths.length === points.length) {
        return widths[i];
    }
    const share = points.length > 1 ? i / (points.length - 1) : 0;
    return widths[0] + (widths[widths.length - 1] - widths[0]) * share;
}

/** The branch of a view with the axis closest to a pixel, and the segment of the axis. */
export function branchAt(sketch: Sketch, view: string, at: Pixel, most: number): { name: string; piece: number; far: number } | null {
    let best: { name: string; piece: number; far: number } | null = null;
    for (const { name, strokes } of sketch.branches) {
        const points = strokes[view]?.points ?? [];
        for (let i = 1; i < points.length; ++i) {
            const { far } = toSegment(at[0], at[1], points[i - 1], points[i]);
            if (far <= (best?.far ?? most)) {
                best = { name, piece: i, far };
            }
        }
    }
    return best;
}

function withBranch(sketch: Sketch, name: string, change: (branch: Branch) => Branch): Sketch {
    return { ...sketch, branches: sketch.branches.map((branch) => (branch.name === name ? change(branch) : branch)) };
}

/** Simplifies a drawn line to a stroke. `widths` belong to the points. */
export function drawnStroke(line: readonly Pixel[], widths: readonly number[], most: number): Stroke | null {
    const kept = simplified(
        line.map(([x, y], i) => [x, y, widths[i]] as const),
        most,
    );
    const far = kept.reduce((sum, [x, y], i) => sum + (i > 0 ? Math.hypot(x - kept[i - 1][0], y - kept[i - 1][1]) : 0), 0);
    if (kept.length < 2 || far < 3 * most) {
        return null;
    }
    const round = (value: number) => Math.round(value * 10) / 10;
    return { points: kept.map(([x, y]) => [round(x), round(y)]), widths: kept.map(([, , width]) => Math.max(round(width), 0.1)) };
}

/**
 * Adds a stroke in a view: to the chosen branch if it has no stroke there, otherwise as a new branch, with the branch near its
 * start as parent.
 */
export function addStroke(sketch: Sketch, view: string, stroke: Stroke, chosen: string | null): { sketch: Sketch; name: string } {
    const branch = chosen ? branchCalled(sketch, chosen) : undefined;
    if (branch && !branch.strokes[view]) {
        const strokes = { ...branch.strokes, [view]: stroke };
        return { sketch: withBranch(sketch, branch.name, (old) => ({ ...old, strokes })), name: branch.name };
    }
    const name = freeBranch(sketch);
    const parent = branchAt(sketch, view, stroke.points[0], kNearParent)?.name;
    const added: Branch = { name, ...(parent !== undefined ? { parent } : {}), strokes: { [view]: stroke } };
    return { sketch: { ...sketch, branches: [...sketch.branches, added] }, name };
}

export function changeStroke(sketch: Sketch, name: string, view: string, change: (stroke: Stroke) => Stroke | null): Sketch {
    return withBranch(sketch, name, (branch) => {
        const stroke = branch.strokes[view];
        const changed = stroke ? change(stroke) : null;
        const { [view]: _, ...others } = branch.strokes;
        return { ...branch, strokes: changed ? { ...branch.strokes, [view]: changed } : others };
    });
}

const fullWidths = (stroke: Stroke): number[] => stroke.points.map((_, i) => widthAt(stroke, i));

export function movePoint(stroke: Stroke, i: number, to: Pixel): Stroke {
    return { ...stroke, points: stroke.points.map((point, k) => (k === i ? to : point)) };
}

export function setWidth(stroke: Stroke, i: number, width: number): Stroke {
    return { ...stroke, widths: fullWidths(stroke).map((old, k) => (k === i ? Math.max(width, 0.1) : old)) };
}

/** Inserts before the point with index `i`. */
export function insertPoint(stroke: Stroke, i: number, at: Pixel): Stroke {
    const widths = fullWidths(stroke);
    const width = (widths[i - 1] + widths[Math.min(i, widths.length - 1)]) / 2;
    return {
        points: [...stroke.points.slice(0, i), at, ...stroke.points.slice(i)],
        widths: [...widths.slice(0, i), width, ...widths.slice(i)],
    };
}

/** Null if fewer than two points would remain. */
export function removePoint(stroke: Stroke, i: number): Stroke | null {
    const keep = (_: unknown, k: number) => k !== i;
    return stroke.points.length > 2 ? { points: stroke.points.filter(keep), widths: fullWidths(stroke).filter(keep) } : null;
}

/** Its children become children of its parent. */
export function removeBranch(sketch: Sketch, name: string): Sketch {
    const parent = branchCalled(sketch, name)?.parent;
    const branches = sketch.branches
        .filter((branch) => branch.name !== name)
        .map((branch) => {
            if (branch.parent !== name) {
                return branch;
            }
            const { parent: _, ...rest } = branch;
            return parent !== undefined ? { ...rest, parent } : rest;
        });
    return { ...sketch, branches };
}

/** Returns the sketch unchanged if another branch has that name, or if the name is empty. */
export function renameBranch(sketch: Sketch, name: string, to: string): Sketch {
    if (to.trim() === "" || branchCalled(sketch, to)) {
        return sketch;
    }
    const branches = sketch.branches.map((branch) => ({
        ...branch,
        name: branch.name === name ? to : branch.name,
        ...(branch.parent === name ? { parent: to } : {}),
    }));
    return { ...sketch, branches };
}

/** Returns the sketch unchanged if the branch would become its own ancestor. */
export function setParent(sketch: Sketch, name: string, parent: string | null): Sketch {
    for (let at = parent; at !== null; at = branchCalled(sketch, at)?.parent ?? null) {
        if (at === name) {
            return sketch;
        }
    }
    return withBranch(sketch, name, ({ parent: _, attach: __, ...rest }) => (parent !== null ? { ...rest, parent } : rest));
}

/** A view with an image under its strokes. Camera files contain the size. */
export function withPicture(view: SketchView, image: string, { width, height }: { width: number; height: number }): SketchView {
    const hasFile = view.colmap !== undefined || view.phenomenal !== undefined;
    return hasFile ? { ...view, image } : { ...view, image, width, height };
}

/** The strokes of a view are kept or removed together with the view. */
export function changeView(sketch: Sketch, index: number, view: SketchView): Sketch {
    const before = sketch.views[index]?.name;
    const branches =
        before === view.name
            ? sketch.branches
            : sketch.branches.map((branch) => {
                  const strokes = Object.entries(branch.strokes).map(([name, stroke]) => [name === before ? view.name : name, stroke] as const);
                  return { ...branch, strokes: Object.fromEntries(strokes) };
              });
    return { ...sketch, views: sketch.views.map((old, i) => (i === index ? view : old)), branches };
}

export function removeView(sketch: Sketch, index: number): Sketch {
    const gone = sketch.views[index]?.name;
    const branches = sketch.branches.map((branch) => {
        const { [gone]: _, ...strokes } = branch.strokes;
        return { ...branch, strokes };
    });
    return { ...sketch, views: sketch.views.filter((_, i) => i !== index), branches };
}

/** The height that a pixel of one scale drawing has in another; null for other kinds of views. */
export function levelIn(from: SketchView, other: SketchView, at: Pixel): number | null {
    const drawings = [from, other].every((view) => view.orthographic && view.orthographic !== "top" && view.origin && view.pixels_per_metre);
    if (!drawings || !from.origin || !other.origin || !from.pixels_per_metre || !other.pixels_per_metre) {
        return null;
    }
    return other.origin[1] + ((at[1] - from.origin[1]) / from.pixels_per_metre) * other.pixels_per_metre;
}
