// The front view of a skeleton as a few strokes: small, sharp images of branches and trees.
import type { Geometry } from "../../app";

const kNone = 0xffffffff;
const kMargin = 4; // [px]
const kThinnest = 0.7; // [px]
const kClass = 1.5; // ratio of the widths of consecutive classes of strokes
const kMin = 0.6; // [px] shorter steps are joined with the next

export interface Silhouette {
    size: number; // [px] edge length of the square
    strokes: { width: number; path: string }[]; // the thickest first
    nodes: number;
}

interface Frame {
    x(n: number): number;
    y(n: number): number;
    scale: number; // [px/m]
}

/** Fits the front view, x to the right and z up, into a square. */
function frameOf(position: Float32Array, size: number): Frame {
    const [low, high] = [
        [Infinity, Infinity],
        [-Infinity, -Infinity],
    ];
    for (let i = 0; i < position.length; i += 3) {
        for (const [c, value] of [position[i], position[i + 2]].entries()) {
            low[c] = Math.min(low[c], value);
            high[c] = Math.max(high[c], value);
        }
    }
    const [wide, tall] = [high[0] - low[0], high[1] - low[1]];
    const scale = (size - 2 * kMargin) / Math.max(wide, tall, 1e-9);
    const [left, bottom] = [(size - wide * scale) / 2, (size + tall * scale) / 2];
    return {
        x: (n) => left + (position[3 * n] - low[0]) * scale,
        y: (n) => bottom - (position[3 * n + 2] - low[1]) * scale,
        scale,
    };
}

const digits = (value: number) => String(Math.round(value * 10) / 10);

export function silhouetteOf(geometry: Geometry, size: number): Silhouette {
    const position = geometry.arrays.position as Float32Array;
    const radius = geometry.arrays.radius as Float32Array;
    const parent = geometry.arrays.parent as Uint32Array;
    const frame = frameOf(position, size);
    const hasChild = new Uint8Array(parent.length);
    parent.forEach((p) => {
        if (p !== kNone) {
            hasChild[p] = 1;
        }
    });
    const from = new Uint32Array(parent.length); // the node at which the stroke to this node has arrived
    const paths = new Map<number, string[]>();
    for (let n = 0; n < parent.length; ++n) {
        from[n] = n;
        if (parent[n] === kNone) {
            continue;
        }
        const before = from[parent[n]];
        const far = Math.hypot(frame.x(n) - frame.x(before), frame.y(n) - frame.y(before));
        if (far < kMin && hasChild[n]) {
            from[n] = before;
            continue;
        }
        const width = Math.max((radius[n] + radius[before]) * frame.scale, kThinnest);
        const rank = Math.round(Math.log(width) / Math.log(kClass));
        const mine = paths.get(rank) ?? [];
        mine.push(`M${digits(frame.x(before))} ${digits(frame.y(before))}L${digits(frame.x(n))} ${digits(frame.y(n))}`);
        paths.set(rank, mine);
    }
    const strokes = [...paths].sort(([a], [b]) => b - a).map(([rank, path]) => ({ width: kClass ** rank, path: path.join("") }));
    return { size, strokes, nodes: parent.length };
}
