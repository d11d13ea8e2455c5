// Computes the bend of an axis that brings its dragged point to the pointer.
import type { Point } from "../../protocol";
import { add, cross, distance, length, normalized, perpendicular, rotated, subtract } from "../kit/vector";

const kSamples = 72; // number of samples of the half turn
const kRefinements = 24;
const kMaxParts = 64;
const kMinLever = 0.3; // relative to the length of the chain

/** The position of a point of a chain, by default its tip, after `edit bend` bends the chain by an angle about an axis. */
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

/**
 * The angle that brings a point, by default the tip, as close as possible to `to`, bending in its direction. Chains have three or
 * more points.
 */
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

/**
 * The point of a chain that controls the bend: the dragged one, but with a minimum distance from the joint, because points near
 * the joint can hardly move.
 */
export function leverOf(chain: readonly Point[], held: number): number {
    const lengths = chain.map((point, i) => (i > 0 ? distance(chain[i - 1], point) : 0));
    const least = kMinLever * lengths.reduce((sum, far) => sum + far, 0);
    let far = 0;
    const reached = lengths.findIndex((length) => (far += length) >= least && length > 0);
    return Math.max(held, reached, 1);
}

function thinned(chain: readonly Point[]): Point[] {
    if (chain.length <= kMaxParts) {
        return [...chain];
    }
    return Array.from({ length: kMaxParts }, (_, i) => chain[Math.round((i * (chain.length - 1)) / (kMaxParts - 1))]);
}
