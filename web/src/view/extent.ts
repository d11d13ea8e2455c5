// Which nodes of a skeleton belong to a picked one.
import type { Geometry, Selection } from "../app";

const kNone = 0xffffffff;

/** A skeleton by places in its arrays; built once for each geometry. */
export interface Tree {
    parent: Uint32Array;
    radius: Float32Array;
    leader: Uint32Array; // the child of greatest radius, the first of equal ones; none: 0xffffffff
    place: Map<number, number>; // of a stable id
    id: Uint32Array;
}

const kept = new WeakMap<Geometry, Tree>();

export function treeOf(geometry: Geometry): Tree {
    let tree = kept.get(geometry);
    if (!tree) {
        tree = buildTree(geometry);
        kept.set(geometry, tree);
    }
    return tree;
}

function buildTree(geometry: Geometry): Tree {
    const parent = geometry.arrays.parent as Uint32Array;
    const radius = geometry.arrays.radius as Float32Array;
    const id = geometry.arrays.id as Uint32Array;
    const leader = new Uint32Array(parent.length).fill(kNone);
    const place = new Map<number, number>();
    for (let n = 0; n < parent.length; ++n) {
        place.set(id[n], n);
        const p = parent[n];
        if (p !== kNone && (leader[p] === kNone || radius[n] > radius[leader[p]])) {
            leader[p] = n;
        }
    }
    return { parent, radius, leader, place, id };
}

/** The radius at the inner end of a node's segment: of laterals that of the node, so that they do not flare. */
export function innerRadius({ parent, radius, leader }: Tree, node: number): number {
    const p = parent[node];
    return p !== kNone && leader[p] === node ? radius[p] : radius[node];
}

function branchOf(tree: Tree, node: number): number[] {
    let first = node;
    while (tree.parent[first] !== kNone && tree.leader[tree.parent[first]] === first) {
        first = tree.parent[first];
    }
    const nodes: number[] = [];
    for (let n = first; n !== kNone; n = tree.leader[n]) {
        nodes.push(n);
    }
    return nodes;
}

// Parents precede children, so that one pass finds all that hang from a node.
function subtreeOf(tree: Tree, node: number): number[] {
    const inside = new Uint8Array(tree.parent.length);
    inside[node] = 1;
    const nodes = [node];
    for (let n = node + 1; n < inside.length; ++n) {
        if (tree.parent[n] !== kNone && inside[tree.parent[n]]) {
            inside[n] = 1;
            nodes.push(n);
        }
    }
    return nodes;
}

function rootOf(tree: Tree, node: number): number {
    let root = node;
    while (tree.parent[root] !== kNone) {
        root = tree.parent[root];
    }
    return root;
}

// What runs on without a fork on either side, from the first node behind a fork to the next fork or tip.
function chainOf(tree: Tree, node: number): number[] {
    const forks = new Uint8Array(tree.parent.length); // children counted up to two
    for (const p of tree.parent) {
        if (p !== kNone && forks[p] < 2) {
            ++forks[p];
        }
    }
    let first = node;
    while (tree.parent[first] !== kNone && forks[tree.parent[first]] === 1) {
        first = tree.parent[first];
    }
    const nodes = [first];
    for (let n = first; forks[n] === 1; ) {
        n = tree.leader[n];
        nodes.push(n);
    }
    return nodes;
}

/** Places of the nodes that an extent around the node with this stable id has; empty where there is no such node. */
export function extentOf(tree: Tree, id: number, extent: Selection["extent"]): number[] {
    const node = tree.place.get(id);
    if (node === undefined) {
        return [];
    }
    switch (extent) {
        case "node":
            return [node];
        case "branch":
            return branchOf(tree, node);
        case "subtree":
            return subtreeOf(tree, node);
        case "tree":
            return subtreeOf(tree, rootOf(tree, node));
        case "connected":
            return chainOf(tree, node);
    }
}
