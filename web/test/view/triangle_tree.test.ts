// Ray tests in a tree of triangles: the same results as for all triangles.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Point } from "../../src/protocol";
import { TriangleTree } from "../../src/view/picking/triangle_tree";

// Pseudo-random numbers that are the same each time.
function numbers(): () => number {
    let state = 7;
    return () => {
        state = (state * 16807) % 2147483647;
        return state / 2147483647;
    };
}

function soup(count: number): { position: Float32Array; index: Uint32Array } {
    const next = numbers();
    const position = new Float32Array(9 * count);
    for (let t = 0; t < count; ++t) {
        const middle = [next() * 10, next() * 10, next() * 10];
        for (let k = 0; k < 9; ++k) {
            position[9 * t + k] = middle[k % 3] + next() - 0.5;
        }
    }
    return { position, index: Uint32Array.from({ length: 3 * count }, (_, i) => i) };
}

function unit([x, y, z]: Point): Point {
    const size = Math.hypot(x, y, z);
    return [x / size, y / size, z / size];
}

test("a ray hits the same triangle with the tree as by brute force", () => {
    const { position, index } = soup(700);
    const tree = new TriangleTree(position, index);
    const each = Array.from({ length: 700 }, (_, t) => new TriangleTree(position, index.slice(3 * t, 3 * t + 3)));
    const next = numbers();
    let hits = 0;
    for (let k = 0; k < 200; ++k) {
        const origin: Point = [next() * 10, next() * 10, -5];
        const direction = unit([next() - 0.5, next() - 0.5, 1]);
        const slow = each.map((one) => one.hit(origin, direction)).reduce<number | null>((a, b) => (a === null || (b !== null && b < a) ? b : a), null);
        assert.equal(tree.hit(origin, direction), slow);
        hits += slow === null ? 0 : 1;
    }
    assert.ok(hits > 50 && hits < 200);
});

test("a square is hit from both sides and at its edges, but not outside", () => {
    const tree = new TriangleTree(new Float32Array([0, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1, 2]), new Uint32Array([0, 1, 2, 0, 2, 3]));
    assert.equal(tree.hit([0.25, 0.5, 0], [0, 0, 1]), 2);
    assert.equal(tree.hit([0.25, 0.5, 5], [0, 0, -1]), 3);
    assert.equal(tree.hit([0.5, 0.5, 0], [0, 0, 1]), 2); // on the diagonal
    assert.equal(tree.hit([1.25, 0.5, 0], [0, 0, 1]), null);
    assert.equal(tree.hit([0.25, 0.5, 3], [0, 0, 1]), null); // behind the ray
});

test("rays pass through hidden triangles", () => {
    const square = (z: number) => [0, 0, z, 1, 0, z, 1, 1, z];
    const tree = new TriangleTree(new Float32Array([...square(1), ...square(2)]), new Uint32Array([0, 1, 2, 3, 4, 5]));
    assert.equal(
        tree.hit([0.75, 0.5, 0], [0, 0, 1], (distance) => distance > 1.5),
        2,
    );
});

test("an empty tree has no hits, and coincident triangles are divided", () => {
    assert.equal(new TriangleTree(new Float32Array(0), new Uint32Array(0)).hit([0, 0, 0], [0, 0, 1]), null);
    const same = new Float32Array([0, 0, 1, 1, 0, 1, 0, 1, 1]);
    const tree = new TriangleTree(
        same,
        Uint32Array.from({ length: 300 }, (_, i) => i % 3),
    );
    assert.equal(tree.hit([0.25, 0.25, 0], [0, 0, 1]), 1);
});
