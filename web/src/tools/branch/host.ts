// The attachment of a branch: a point on the axis of its parent branch.
import type { App } from "../../app";
import type { Point } from "../../protocol";
import type { Skeleton } from "../kit/skeleton";
import { dot, subtract } from "../kit/vector";

const kAtNode = 0.01; // relative to a segment

export interface Host {
    n: number;
    along: number; // position on its segment, 1 at the node
}

/** The parameter in [0, 1] of the closest point on the segment that leads to n. */
export function alongSegment(skeleton: Skeleton, n: number, place: Point): number {
    const parent = skeleton.parent(n);
    if (parent < 0) {
        return 1;
    }
    const edge = subtract(skeleton.at(n), skeleton.at(parent));
    const size = dot(edge, edge);
    return size > 0 ? Math.min(Math.max(dot(subtract(place, skeleton.at(parent)), edge) / size, 0), 1) : 1;
}

/** A point on a segment; at the start of the segment, the previous node. */
export function hostAt(skeleton: Skeleton, n: number, along: number): Host {
    const parent = skeleton.parent(n);
    return along < kAtNode && parent >= 0 ? { n: parent, along: 1 } : { n, along };
}

/** The point of a skeleton under the pointer; nodes of `but` are excluded. */
export function hostUnder(app: App, name: string, skeleton: Skeleton, x: number, y: number, but?: ReadonlySet<number>): Host | null {
    const pick = app.view.pick(x, y, ["skeleton"]);
    const n = pick?.node !== undefined && pick.object.name === name ? skeleton.index(pick.node) : -1;
    if (pick && n >= 0 && !but?.has(n)) {
        return hostAt(skeleton, n, alongSegment(skeleton, n, pick.point));
    }
    const found = skeleton.nearest(x, y, (point) => app.view.toPixels(point), 12, but);
    return found ? hostAt(skeleton, found.node, found.share) : null;
}
