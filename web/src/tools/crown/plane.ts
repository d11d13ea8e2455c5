// The plane of the profile editor: conversion between pixels and metres, and the statement of its points.
import type { Controls } from "../kit/source";
import { roundStep, toSegment } from "../kit/vector";
import { commandLine, numberWord, pointWord } from "../kit/words";

export type Place = readonly [number, number]; // [m] x, y; y upward

export interface Plane {
    scale: number; // [px] per metre
    left: number; // [px] where x is 0
    top: number; // [px] where y is 0
}

export const toPixel = ({ scale, left, top }: Plane, [x, y]: Place): [number, number] => [left + x * scale, top - y * scale];
export const toPlace = ({ scale, left, top }: Plane, x: number, y: number): [number, number] => [(x - left) / scale, (top - y) / scale];

/** Zooms with the point under the pointer fixed. */
export function zoomed(plane: Plane, x: number, y: number, factor: number): Plane {
    const scale = Math.min(Math.max(plane.scale * factor, 1e-3), 1e6);
    const by = scale / plane.scale;
    return { scale, left: x + (plane.left - x) * by, top: y + (plane.top - y) * by };
}

/** A plane that shows all points and the axis. */
export function framing(points: readonly Place[], width: number, height: number): Plane {
    const xs = [0, ...points.map(([x]) => x)];
    const ys = [0, ...points.map(([, y]) => y)];
    const [low, high, bottom, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const size = Math.max((high - low) / width, (top - bottom) / height);
    const scale = size > 0 ? 0.8 / size : Math.min(width, height) / 4;
    return { scale, left: width / 2 - ((low + high) / 2) * scale, top: height / 2 + ((bottom + top) / 2) * scale };
}

/** [m] spacing of the grid: about 40 pixels. */
export const gridStep = (plane: Plane): number => roundStep(40 / plane.scale);

/** The index before which a click on the outline inserts a point; -1 if the click hits no segment. */
export function pieceAt(points: readonly Place[], closed: boolean, plane: Plane, x: number, y: number, most: number): number {
    const pixels = points.map((point) => toPixel(plane, point));
    const pieces = closed && points.length > 2 ? points.length : points.length - 1;
    let best = -1;
    let far = most;
    for (let i = 0; i < pieces; ++i) {
        const off = toSegment(x, y, pixels[i], pixels[(i + 1) % pixels.length]).far;
        if (off <= far) {
            [best, far] = [i + 1, off];
        }
    }
    return best;
}

export interface Outline {
    command: "profile" | "contour";
    name: string;
    points: readonly Place[];
    closed: boolean;
    kind: string; // kind of the interpolation between points
}

/** The statement of an outline; options that the editor does not show are preserved. */
export function outlineLine(outline: Outline, step: number, before?: Pick<Controls, "options" | "comment">): string {
    const kept = Object.fromEntries(Object.entries(before?.options ?? {}).filter(([key]) => key !== "closed" && key !== "kind"));
    const points = outline.points.map((point) => pointWord(point, step));
    const own =
        outline.command === "profile" ? { kind: outline.kind === "polyline" ? undefined : outline.kind, closed: outline.closed ? undefined : "false" } : {};
    const line = commandLine([outline.command, outline.name, ...points], { ...own, ...kept });
    return before?.comment ? `${line} ${before.comment}` : line;
}

export const placeText = (place: Place, step: number): string => place.map((value) => numberWord(value, step)).join(", ");

// The control point of a cubic next to `at`, between the neighbours `from` and `to`.
const tangent = (at: Place, from: Place, to: Place): string => at.map((value, k) => value + (to[k] - from[k]) / 6).join(" ");

/** The outline as SVG path data, smooth if the curve is smooth: an approximation that is sufficient for editing. */
export function outlinePath(points: readonly Place[], closed: boolean, smooth: boolean, plane: Plane): string {
    const at = points.map((point) => toPixel(plane, point));
    if (at.length < 2) {
        return "";
    }
    const count = at.length;
    const get = (i: number) => (closed ? at[(i + count) % count] : at[Math.min(Math.max(i, 0), count - 1)]);
    let path = `M${at[0].join(" ")}`;
    for (let i = 0; i < (closed ? count : count - 1); ++i) {
        const [a, b, c, d] = [get(i - 1), get(i), get(i + 1), get(i + 2)];
        path += smooth ? `C${tangent(b, a, c)} ${tangent(c, d, b)} ${c.join(" ")}` : `L${c.join(" ")}`;
    }
    return path;
}
