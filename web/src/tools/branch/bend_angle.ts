// By how much an axis is to be bent so that what a hand holds of it comes where it was dragged.
import type { Point } from "../../protocol";
import { add, cross, distance, length, normalized, perpendicular, rotated, subtract } from "../kit/vector";

const kSamples = 72; // of the half turn that is searched
const kRefinements = 24;
const kMostParts = 64;
const kLeastLever = 0.3; // of the chain's length

/** Where a point of a chain, its tip if none is named, comes when `edit bend` bends the chain by an angle about an axis. */
export function bentTip(chain: readonly Point[], axis: Point, angle: number, held = chain.length - 1): Point {
    let whole = 0;
    for (let i = 1; i + 1 < chain.length; ++i) {
        whole += distance(chain[i - 1], chain[i]);
    }
    let tip = chain[0];
    let before = 0;
    for (let i = 1; i <= held; ++i) {
        const edge = subtract(chain[i], chain[i - 1]);
        tip = add(tip, rotated(edge, axis, whole > 0 ? (angle * before) / whole : 0));
        before += length(edge);
    }
    return tip;
}

export interface Bend {
    degrees: number;
    towards: Point;
}

/** The angle that brings a point, the tip if none is named, as near to `to` as it can come, bending towards there. Chains have three points or more. */
export function bendTo(chain: readonly Point[], to: Point, held = chain.length - 1): Bend {
    const parts = thinned(chain);
    const at = Math.round((held * (parts.length - 1)) / (chain.length - 1));
    const by = subtract(to, chain[held]);
    const first = normalized(subtract(parts[1], parts[0]));
    const towards = normalized(by, perpendicular(first));
    const axis = normalized(cross(first, towards), perpendicular(first));
    const goal = add(parts[at], by);
    const off = (angle: number) => distance(bentTip(parts, axis, angle, at), goal);
    let best = 0;
    const width = Math.PI / kSamples;
    for (let i = 1; i <= kSamples; ++i) {
        if (off(i * width) < off(best)) {
            best = i * width;
        }
    }
    let [low, high] = [Math.max(best - width, 0), Math.min(best + width, Math.PI)];
    for (let i = 0; i < kRefinements; ++i) {
        const [a, b] = [low + (high - low) / 3, high - (high - low) / 3];
        if (off(a) < off(b)) {
            high = b;
        } else {
            low = a;
        }
    }
    return { degrees: ((low + high) * 90) / Math.PI, towards };
}

/** The place of a chain that bends it: the one that is held, but none so near to the joint that it could hardly move. */
export function leverOf(chain: readonly Point[], held: number): number {
    const lengths = chain.map((point, i) => (i > 0 ? distance(chain[i - 1], point) : 0));
    const least = kLeastLever * lengths.reduce((sum, far) => sum + far, 0);
    let far = 0;
    const reached = lengths.findIndex((length) => (far += length) >= least && length > 0);
    return Math.max(held, reached, 1);
}

function thinned(chain: readonly Point[]): Point[] {
    if (chain.length <= kMostParts) {
        return [...chain];
    }
    return Array.from({ length: kMostParts }, (_, i) => chain[Math.round((i * (chain.length - 1)) / (kMostParts - 1))]);
}
