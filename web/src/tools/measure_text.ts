// Measures of picked points: distances, an angle, heights, and the radius of the branch.
import type { Point } from "../protocol";
import { angleBetween, distance, subtract } from "./kit/vector";
import { lengthText, shortNumber } from "../view/lengths";

export interface Spot {
    at: Point;
    radius?: number; // [m] of the branch there
    of?: string; // the object at the point: "node 12 of tree"
}

/** Up to three points: two have a distance, three also the angle at the second. */
export type Measure = readonly Spot[];

export const kMaxSpots = 3;

export const angleAt = ([a, b, c]: Measure): number => angleBetween(subtract(a.at, b.at), subtract(c.at, b.at));

export function degreesText(angle: number): string {
    return `${shortNumber((angle * 180) / Math.PI, 4)}°`;
}

export function branchText(radius: number): string {
    return `radius ${lengthText(radius)}, diameter ${lengthText(2 * radius)}`;
}

/** Description of a point: "node 12 of tree: radius 3 cm, diameter 6 cm; 1.2 m above the ground". */
export function spotText({ at, radius, of }: Spot): string {
    const height = at[2] < 0 ? `${lengthText(-at[2])} below the ground` : `${lengthText(at[2])} above the ground`;
    return `${of ? `${of}: ` : ""}${radius === undefined ? "" : `${branchText(radius)}; `}${height}`;
}

/** All texts of a measure, for a list and to be copied. */
export function measureText(measure: Measure): string[] {
    const [a, b, c] = measure;
    if (!b) {
        return a ? [spotText(a)] : [];
    }
    const [, , rise] = subtract(b.at, a.at);
    const flat = Math.hypot(b.at[0] - a.at[0], b.at[1] - a.at[1]);
    const first = [`distance ${lengthText(distance(a.at, b.at), 4)}`, `${lengthText(flat, 4)} across the ground, ${lengthText(rise, 4)} up`];
    return c ? [...first, `distance ${lengthText(distance(b.at, c.at), 4)}`, `angle ${degreesText(angleAt(measure))}`] : first;
}

/** The radius of a segment between two nodes at the closest point to a position; the end of the parent is first. */
export function radiusAt(at: Point, from: Point, to: Point, radii: readonly [number, number]): number {
    const [along, off] = [subtract(to, from), subtract(at, from)];
    const size = along[0] ** 2 + along[1] ** 2 + along[2] ** 2;
    const share = size > 0 ? Math.min(Math.max((along[0] * off[0] + along[1] * off[1] + along[2] * off[2]) / size, 0), 1) : 1;
    return radii[0] + (radii[1] - radii[0]) * share;
}
