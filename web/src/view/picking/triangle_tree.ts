// A bounding volume hierarchy of triangles for ray tests.
import type { Point } from "../../protocol";

const kLeaf = 8; // maximum number of triangles of a leaf

export class TriangleTree {
    private readonly order: Uint32Array; // triangles; those of a node are consecutive
    private readonly boxes: number[] = []; // of each node: minimum, maximum
    private readonly nodes: number[] = []; // of each: first and end in `order`, index of the second child (the first follows) or -1
    private readonly middles: Float32Array;

    /** O(n log n). The arrays are read, not copied. */
    constructor(
        private readonly position: Float32Array,
        private readonly index: Uint32Array,
    ) {
        const count = Math.floor(index.length / 3);
        this.order = Uint32Array.from({ length: count }, (_, i) => i);
        this.middles = new Float32Array(3 * count);
        for (let t = 0; t < count; ++t) {
            for (let c = 0; c < 3; ++c) {
                this.middles[3 * t + c] = (this.at(t, 0, c) + this.at(t, 1, c) + this.at(t, 2, c)) / 3;
            }
        }
        if (count > 0) {
            this.build(0, count);
        }
    }

    /** The distance along the ray to the closest visible triangle; null if there is no hit. The direction has length 1. */
    hit(origin: Point, direction: Point, isSeen: (distance: number) => boolean = () => true): number | null {
        let best = Infinity;
        const waiting = this.nodes.length > 0 ? [0] : [];
        const inverse = direction.map((c) => 1 / c) as Point;
        for (let node = waiting.pop(); node !== undefined; node = waiting.pop()) {
            if (this.enters(node, origin, inverse) >= best) {
                continue;
            }
            const [first, end, second] = [this.nodes[3 * node], this.nodes[3 * node + 1], this.nodes[3 * node + 2]];
            if (second < 0) {
                for (let i = first; i < end; ++i) {
                    const far = this.meets(this.order[i], origin, direction);
                    if (far < best && isSeen(far)) {
                        best = far;
                    }
                }
            } else if (this.enters(node + 1, origin, inverse) < this.enters(second, origin, inverse)) {
                waiting.push(second, node + 1); // the closer one first
            } else {
                waiting.push(node + 1, second);
            }
        }
        return Number.isFinite(best) ? best : null;
    }

    private at(triangle: number, corner: number, c: number): number {
        return this.position[3 * this.index[3 * triangle + corner] + c];
    }

    private build(first: number, end: number): void {
        const node = this.nodes.length / 3;
        this.nodes.push(first, end, -1);
        this.boxes.push(Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity);
        if (end - first <= kLeaf) {
            for (let i = first; i < end; ++i) {
                this.widen(node, this.order[i]);
            }
            return;
        }
        const [axis, at] = this.cut(first, end);
        let middle = this.part(first, end, axis, at);
        if (middle === first || middle === end) {
            middle = (first + end) >> 1; // all centres coincide
        }
        this.build(first, middle);
        const second = this.nodes.length / 3;
        this.nodes[3 * node + 2] = second;
        this.build(middle, end);
        for (let c = 0; c < 3; ++c) {
            this.boxes[6 * node + c] = Math.min(this.boxes[6 * (node + 1) + c], this.boxes[6 * second + c]);
            this.boxes[6 * node + 3 + c] = Math.max(this.boxes[6 * (node + 1) + 3 + c], this.boxes[6 * second + 3 + c]);
        }
    }

    private widen(node: number, triangle: number): void {
        for (let c = 0; c < 3; ++c) {
            const [a, b, d] = [this.at(triangle, 0, c), this.at(triangle, 1, c), this.at(triangle, 2, c)];
            this.boxes[6 * node + c] = Math.min(this.boxes[6 * node + c], a, b, d);
            this.boxes[6 * node + 3 + c] = Math.max(this.boxes[6 * node + 3 + c], a, b, d);
        }
    }

    /** The axis with the largest extent of the centres, and its middle. */
    private cut(first: number, end: number): [number, number] {
        const { order, middles } = this;
        let best = 0;
        let widest = -1;
        let at = 0;
        for (let c = 0; c < 3; ++c) {
            let low = Infinity;
            let high = -Infinity;
            for (let i = first; i < end; ++i) {
                const value = middles[3 * order[i] + c];
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
            if (high - low > widest) {
                [best, widest, at] = [c, high - low, (low + high) / 2];
            }
        }
        return [best, at];
    }

    /** Partitions at the plane; returns the start of the second half. */
    private part(first: number, end: number, axis: number, at: number): number {
        let middle = first;
        for (let i = first; i < end; ++i) {
            const t = this.order[i];
            if (this.middles[3 * t + axis] < at) {
                this.order[i] = this.order[middle];
                this.order[middle++] = t;
            }
        }
        return middle;
    }

    /** The distance along the ray to the box of a node; Infinity without a hit. */
    private enters(node: number, origin: Point, inverse: Point): number {
        let from = 0;
        let to = Infinity;
        for (let c = 0; c < 3; ++c) {
            const a = (this.boxes[6 * node + c] - origin[c]) * inverse[c];
            const b = (this.boxes[6 * node + 3 + c] - origin[c]) * inverse[c];
            if (a === a && b === b) {
                // 0 / 0: the ray runs in a side of the box
                from = Math.max(from, Math.min(a, b));
                to = Math.min(to, Math.max(a, b));
            }
        }
        return from <= to * (1 + 1e-7) ? from : Infinity;
    }

    /** The distance along the ray to a triangle, from either side (Möller and Trumbore); Infinity without a hit. */
    private meets(t: number, [ox, oy, oz]: Point, [dx, dy, dz]: Point): number {
        const [ax, ay, az] = [this.at(t, 0, 0), this.at(t, 0, 1), this.at(t, 0, 2)];
        const [ux, uy, uz] = [this.at(t, 1, 0) - ax, this.at(t, 1, 1) - ay, this.at(t, 1, 2) - az];
        const [vx, vy, vz] = [this.at(t, 2, 0) - ax, this.at(t, 2, 1) - ay, this.at(t, 2, 2) - az];
        const [px, py, pz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
        const volume = ux * px + uy * py + uz * pz;
        if (volume === 0) {
            return Infinity;
        }
        const [sx, sy, sz] = [ox - ax, oy - ay, oz - az];
        const u = (sx * px + sy * py + sz * pz) / volume;
        const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
        const v = (dx * qx + dy * qy + dz * qz) / volume;
        const far = (vx * qx + vy * qy + vz * qz) / volume;
        return u >= 0 && v >= 0 && u + v <= 1 && far > 0 ? far : Infinity;
    }
}
