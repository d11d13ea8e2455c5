// Finds the nodes of a skeleton that belong to a picked one.
import type { Geometry, Selection } from "../app";

const kNone = 0xffffffff;

/** A skeleton with array indices as node numbers; built once for each geometry. */
export interface Tree {
    parent: Uint32Array;
    radius: Float32Array;
    leader: Uint32Array; // the child of maximum radius, the first of equal ones; no child: 0xffffffff
    place: Map<number, number>; // index of a stable id
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

/** The radius at the inner end of the segment of a node: for laterals the radius of the node, so that they do not flare. */
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

// Parents precede children, so that one pass finds all descendants of a node.
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

// The unforked chain around a node, from the first node after a fork to the next fork or tip.
function chainOf(tree: Tree, node: number): number[] {
    const forks = new Uint8Array(tree.parent.length); // number of children, at most two
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
    for (let n = first; forks[n] === 1;) {
        n = tree.leader[n];
        nodes.push(n);
    }
    return nodes;
}

/** Indices of the nodes in an extent around the node with this stable id; empty if the node does not exist. */
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
