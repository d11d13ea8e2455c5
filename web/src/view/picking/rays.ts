// Ray tests for tapered capsules, points and lines.
import type { Point } from "../../protocol";
import { innerRadius, type Tree } from "../extent";

const kNone = 0xffffffff;

export interface Hit {
    distance: number; // [m] along the ray
    node: number; // index of the outer node of the segment
}

/**
 * The closest segment of a skeleton that a ray intersects. The thickness of a segment is at least `least(distance)`, so that
 * twigs thinner than a few pixels can be picked. `isSeen` excludes hidden points. Cost: O(segments).
 */
export function hitSkeleton(
    tree: Tree,
    position: Float32Array,
    origin: Point,
    direction: Point,
    least: (distance: number) => number,
    isSeen: (distance: number) => boolean = () => true,
): Hit | null {
    const { parent, radius } = tree;
    const [ox, oy, oz] = origin;
    const [dx, dy, dz] = direction;
    let best: Hit | null = null;
    for (let n = 0; n < parent.length; ++n) {
        const p = parent[n] === kNone ? n : parent[n];
        const ax = position[3 * p] - ox;
        const ay = position[3 * p + 1] - oy;
        const az = position[3 * p + 2] - oz;
        const ux = position[3 * n] - ox - ax;
        const uy = position[3 * n + 1] - oy - ay;
        const uz = position[3 * n + 2] - oz - az;
        // The closest points of ray and segment.
        const uu = ux * ux + uy * uy + uz * uz;
        const ud = ux * dx + uy * dy + uz * dz;
        const ua = ux * ax + uy * ay + uz * az;
        const da = dx * ax + dy * ay + dz * az;
        const span = uu - ud * ud;
        let s = span > 1e-12 * uu ? (ud * da - ua) / span : 0;
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        const along = da + s * ud;
        if (along <= 0) {
            continue;
        }
        const cx = ax + s * ux - along * dx;
        const cy = ay + s * uy - along * dy;
        const cz = az + s * uz - along * dz;
        const apart = cx * cx + cy * cy + cz * cz;
        const inner = innerRadius(tree, n);
        const thick = Math.max(inner + (radius[n] - inner) * s, least(along));
        if (apart > thick * thick) {
            continue;
        }
        const distance = Math.max(along - Math.sqrt(thick * thick - apart), 0);
        if ((!best || distance < best.distance) && isSeen(distance)) {
            best = { distance, node: n };
        }
    }
    return best;
}

/** The outer node of the segment with the surface closest to a point. Cost: O(segments). */
export function closestSegment(tree: Tree, position: Float32Array, [x, y, z]: Point): number {
    const { parent, radius } = tree;
    let best = 0;
    let least = Infinity;
    for (let n = 0; n < parent.length; ++n) {
        const p = parent[n] === kNone ? n : parent[n];
        const ax = x - position[3 * p];
        const ay = y - position[3 * p + 1];
        const az = z - position[3 * p + 2];
        const ux = position[3 * n] - position[3 * p];
        const uy = position[3 * n + 1] - position[3 * p + 1];
        const uz = position[3 * n + 2] - position[3 * p + 2];
        const s = Math.min(Math.max((ax * ux + ay * uy + az * uz) / (ux * ux + uy * uy + uz * uz || 1), 0), 1);
        const inner = innerRadius(tree, n);
        const apart = Math.abs(Math.hypot(ax - s * ux, ay - s * uy, az - s * uz) - (inner + (radius[n] - inner) * s));
        if (apart < least) {
            least = apart;
            best = n;
        }
    }
    return best;
}

/** A projection: a 4 x 4 matrix by columns, and the size of the view in pixels. */
export interface Projection {
    matrix: ArrayLike<number>;
    width: number;
    height: number;
}

/** The point within `reach` pixels of (x, y) that is closest to the camera among those within 2 pixels of the closest. */
export function hitPoints(position: Float32Array, to: Projection, x: number, y: number, reach: number): number | null {
    const m = to.matrix;
    let best = -1;
    let bestApart = reach * reach;
    let bestDepth = Infinity;
    for (let i = 0, k = 0; k < position.length; ++i, k += 3) {
        const px = position[k];
        const py = position[k + 1];
        const pz = position[k + 2];
        const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
        if (w <= 0) {
            continue;
        }
        const sx = ((m[0] * px + m[4] * py + m[8] * pz + m[12]) / w + 1) * 0.5 * to.width - x;
        const sy = (1 - (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w) * 0.5 * to.height - y;
        const apart = sx * sx + sy * sy;
        const depth = (m[2] * px + m[6] * py + m[10] * pz + m[14]) / w;
        if (depth < -1 || depth > 1 || apart > reach * reach) {
            continue;
        }
        if (apart < bestApart - 4 || (apart <= bestApart + 4 && depth < bestDepth)) {
            best = i;
            bestApart = Math.min(apart, bestApart);
            bestDepth = depth;
        }
    }
    return best < 0 ? null : best;
}

/** The segment of a polyline that passes within `reach` pixels of (x, y): its first point. */
export function hitLine(position: Float32Array, closed: boolean, to: Projection, x: number, y: number, reach: number): number | null {
    const m = to.matrix;
    const count = position.length / 3;
    const pixels = (i: number): [number, number] | null => {
        const [px, py, pz] = [position[3 * i], position[3 * i + 1], position[3 * i + 2]];
        const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
        return w <= 0
            ? null
            : [((m[0] * px + m[4] * py + m[8] * pz + m[12]) / w + 1) * 0.5 * to.width, (1 - (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w) * 0.5 * to.height];
    };
    let best = -1;
    let least = reach;
    for (let i = 0; i < (closed ? count : count - 1); ++i) {
        const a = pixels(i);
        const b = pixels((i + 1) % count);
        if (!a || !b) {
            continue;
        }
        const ux = b[0] - a[0];
        const uy = b[1] - a[1];
        const t = Math.min(Math.max(((x - a[0]) * ux + (y - a[1]) * uy) / (ux * ux + uy * uy || 1), 0), 1);
        const apart = Math.hypot(a[0] + t * ux - x, a[1] + t * uy - y);
        if (apart < least) {
            least = apart;
            best = i;
        }
    }
    return best < 0 ? null : best;
}
