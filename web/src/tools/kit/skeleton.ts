// A skeleton with its hierarchy and selections, for tools.
import { effect, untracked } from "@preact/signals-core";
import type { App, Geometry, Pick, Selection } from "../../app";
import type { Point } from "../../protocol";
import { meshSources } from "../../view/sources";
import { toSegment } from "./vector";

const kNone = 0xffffffff;
const kMaxFetched = 16;

export type Extent = Selection["extent"];
export const kExtents: readonly Extent[] = ["node", "branch", "subtree", "tree", "connected"];

/** Indices are positions in the arrays of this value; lines use ids. Parents come before their children. */
export class Skeleton {
    readonly size: number;
    readonly children: number[][];
    private readonly indexOf = new Map<number, number>();
    private readonly position: ArrayLike<number>;
    private readonly origin: Point;

    constructor(
        position: ArrayLike<number>,
        readonly radius: ArrayLike<number>,
        private readonly parents: ArrayLike<number>,
        readonly ids: ArrayLike<number>,
        origin: Point = [0, 0, 0],
    ) {
        this.position = position;
        this.origin = origin;
        this.size = radius.length;
        this.children = Array.from({ length: this.size }, () => []);
        for (let n = 0; n < this.size; ++n) {
            this.indexOf.set(ids[n], n);
            if (parents[n] !== kNone) {
                this.children[parents[n]].push(n);
            }
        }
    }

    static of(geometry: Geometry): Skeleton {
        const { position, radius, parent, id } = geometry.arrays;
        return new Skeleton(position, radius, parent, id, geometry.header.origin);
    }

    /** -1 if no node has the id. */
    index(id: number): number {
        return this.indexOf.get(id) ?? -1;
    }

    at(n: number): Point {
        const [x, y, z] = this.origin;
        return [this.position[3 * n] + x, this.position[3 * n + 1] + y, this.position[3 * n + 2] + z];
    }

    /** -1 for a root. */
    parent(n: number): number {
        return this.parents[n] === kNone ? -1 : this.parents[n];
    }

    /** The child that continues the axis: the thickest, the first of several; -1 at a tip. */
    leader(n: number): number {
        let best = -1;
        for (const child of this.children[n]) {
            if (best < 0 || this.radius[child] > this.radius[best]) {
                best = child;
            }
        }
        return best;
    }

    /** The first node of the axis that contains n: a root, or a node that is not the leader of its parent. */
    axisStart(n: number): number {
        for (let parent = this.parent(n); parent >= 0 && this.leader(parent) === n; parent = this.parent(n)) {
            n = parent;
        }
        return n;
    }

    /** From the first node of the axis of n to its tip. */
    axis(n: number): number[] {
        const nodes: number[] = [];
        for (let at = this.axisStart(n); at >= 0; at = this.leader(at)) {
            nodes.push(at);
        }
        return nodes;
    }

    subtree(n: number): number[] {
        const nodes = [n];
        for (let i = 0; i < nodes.length; ++i) {
            nodes.push(...this.children[nodes[i]]);
        }
        return nodes;
    }

    root(n: number): number {
        for (let parent = this.parent(n); parent >= 0; parent = this.parent(n)) {
            n = parent;
        }
        return n;
    }

    roots(): number[] {
        return this.all().filter((n) => this.parent(n) < 0);
    }

    all(): number[] {
        return Array.from({ length: this.size }, (_, n) => n);
    }

    /** The nodes of a selection: those with these ids, and the nodes of their extent. Ids that no longer exist are ignored. */
    selected(ids: readonly number[], extent: Extent): number[] {
        const nodes = new Set<number>();
        for (const id of ids) {
            const n = this.index(id);
            if (n >= 0) {
                this.extended(n, extent).forEach((other) => nodes.add(other));
            }
        }
        return [...nodes];
    }

    extended(n: number, extent: Extent): number[] {
        switch (extent) {
            case "node":
                return [n];
            case "branch":
                return this.axis(n);
            case "subtree":
                return this.subtree(n);
            case "tree":
                return this.subtree(this.root(n));
            case "connected":
                return this.connected(n);
        }
    }

    /** The chain between forks and tips that contains n: adjacent nodes with one child. */
    private connected(n: number): number[] {
        let first = n;
        for (let parent = this.parent(first); parent >= 0 && this.children[parent].length === 1; parent = this.parent(first)) {
            first = parent;
        }
        const nodes = [first];
        for (let at = first; this.children[at].length === 1;) {
            at = this.children[at][0];
            nodes.push(at);
        }
        return nodes;
    }

    /** The nodes that are not descendants of another of the nodes. */
    highest(nodes: readonly number[]): number[] {
        const among = new Set(nodes);
        const below = new Uint8Array(this.size); // whether it or an ancestor is among them
        const tops: number[] = [];
        for (let n = 0; n < this.size; ++n) {
            const parent = this.parent(n);
            const hangs = parent >= 0 && below[parent] === 1;
            if (among.has(n) && !hangs) {
                tops.push(n);
            }
            below[n] = hangs || among.has(n) ? 1 : 0;
        }
        return tops;
    }

    /** Extends the selection by one node along every segment that leaves it. */
    grown(nodes: readonly number[]): number[] {
        const out = new Set(nodes);
        for (const n of nodes) {
            if (this.parent(n) >= 0) {
                out.add(this.parent(n));
            }
            this.children[n].forEach((child) => out.add(child));
        }
        return [...out];
    }

    /** Without tips, and without nodes that have a neighbour outside the selection. */
    shrunk(nodes: readonly number[]): number[] {
        const among = new Set(nodes);
        return nodes.filter((n) => {
            const parent = this.parent(n);
            const inner = this.children[n].length > 0 && this.children[n].every((child) => among.has(child));
            return inner && (parent < 0 || among.has(parent));
        });
    }

    /** The length of the axis from the start of the segment of n to the tip. */
    lengthFrom(n: number): number {
        let sum = 0;
        for (let at = n; at >= 0; at = this.leader(at)) {
            const parent = this.parent(at);
            if (parent >= 0) {
                sum += Math.hypot(...[0, 1, 2].map((k) => this.position[3 * at + k] - this.position[3 * parent + k]));
            }
        }
        return sum;
    }

    /** The node with the segment closest to a position of the view, and the parameter on it: 0 at its parent, 1 at the node. */
    nearest(
        x: number,
        y: number,
        toPixels: (point: Point) => [number, number, number],
        most = Infinity,
        but?: ReadonlySet<number>,
    ): { node: number; share: number; far: number } | null {
        const pixels = this.all().map((n) => toPixels(this.at(n)));
        let best: { node: number; share: number; far: number } | null = null;
        for (let n = 0; n < this.size; ++n) {
            const parent = this.parent(n);
            if (Math.abs(pixels[n][2]) > 1 || but?.has(n)) {
                continue;
            }
            const from = parent >= 0 ? pixels[parent] : pixels[n];
            const { far, share } = toSegment(x, y, from, pixels[n]);
            if (far <= (best?.far ?? most)) {
                best = { node: n, share, far };
            }
        }
        return best;
    }
}

/** The branch under the pointer. Reports an error if its skeleton is hidden and cannot be edited. */
export function pickBranch(app: App, x: number, y: number): Pick | null {
    const pick = app.view.pick(x, y, ["skeleton"]);
    const mesh = pick ? undefined : app.view.pick(x, y, ["mesh"])?.object.name;
    const source = mesh && meshSources(app.store).get(mesh);
    if (source && app.store.hidden.peek().has(`skeleton:${source}`)) {
        app.store.notify(`The skeleton ${source} is hidden; show it in the list of objects to work on its branches.`, "warning");
    }
    return pick;
}

interface Kept {
    version: number;
    geometry: Geometry;
    skeleton: Skeleton;
}

const kept = new Map<string, Kept>();
const fetching = new Map<string, Promise<Skeleton | null>>();

/** The skeleton of this name in the view; null if it has not been received. */
export function skeletonOf(app: App, name: string): Skeleton | null {
    const object = app.store.find("skeleton", name);
    const geometry = app.view.geometry({ kind: "skeleton", name }, "skeleton");
    const known = kept.get(name);
    if (geometry && known?.geometry !== geometry) {
        const skeleton = Skeleton.of(geometry);
        kept.set(name, { version: geometry.header.version, geometry, skeleton });
        return skeleton;
    }
    return known && object && (geometry || known.version === object.version) ? known.skeleton : null;
}

/** The same, requested from the engine if the view shows only the surface. */
export function fetchSkeleton(app: App, name: string): Promise<Skeleton | null> {
    const known = skeletonOf(app, name);
    const object = app.store.find("skeleton", name);
    if (known || !object) {
        return Promise.resolve(known);
    }
    const key = `${name}:${object.version}`;
    const under = fetching.get(key) ?? requestSkeleton(app, name, object.version).finally(() => fetching.delete(key));
    fetching.set(key, under);
    return under;
}

/**
 * Fetches the skeletons of the document, and again whenever they change, until the returned function is called; `known` is called
 * when they have arrived.
 */
export function followSkeletons(app: App, known?: () => void): () => void {
    let isFollowing = true;
    const end = effect(() => {
        const all = app.store.state.value.objects.filter(({ kind }) => kind === "skeleton").slice(0, kMaxFetched);
        void untracked(() => Promise.all(all.map(({ name }) => fetchSkeleton(app, name)))).then(() => isFollowing && known?.());
    });
    return () => {
        isFollowing = false;
        end();
    };
}

// If the skeleton has changed in between, it is requested again.
async function requestSkeleton(app: App, name: string, version: number): Promise<Skeleton | null> {
    const isOld = () => app.store.find("skeleton", name)?.version !== version;
    try {
        const { key } = await app.engine.request<{ key: string }>("show", { kind: "skeleton", name, form: "axes" });
        const geometry = await app.engine.blob(key);
        const skeleton = Skeleton.of(geometry);
        kept.set(name, { version, geometry, skeleton });
        return isOld() ? fetchSkeleton(app, name) : skeleton;
    } catch (error) {
        if (isOld()) {
            return fetchSkeleton(app, name);
        }
        app.store.notify((error as Error).message, "error");
        return null;
    }
}

/** The first nodes of the selected branches, without those on another selected branch; null if no branch is selected. */
export function selectedTops(app: App): { name: string; ids: number[]; skeleton: Skeleton } | null {
    const { object, nodes, extent } = app.store.selection.peek();
    const skeleton = object?.kind === "skeleton" ? skeletonOf(app, object.name) : null;
    const chosen = skeleton?.selected(nodes, extent) ?? [];
    if (!object || !skeleton || chosen.length === 0) {
        return null;
    }
    return { name: object.name, ids: skeleton.highest(chosen).map((n) => skeleton.ids[n]), skeleton };
}
