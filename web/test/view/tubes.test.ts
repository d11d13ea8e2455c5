// Large trees during movements: the thickest segments remain capsules, the others become lines.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Geometry } from "../../src/app";
import { treeOf } from "../../src/view/extent";
import { thickest } from "../../src/view/tubes";

const kNone = 0xffffffff;

function chain(radius: number[]): Geometry {
    const arrays = {
        radius: new Float32Array(radius),
        parent: Uint32Array.from(radius, (_, n) => (n === 0 ? kNone : n - 1)),
        id: Uint32Array.from(radius, (_, n) => n),
        position: new Float32Array(radius.length * 3),
    };
    return { header: {} as Geometry["header"], arrays };
}

test("every segment is drawn as a tube or a line, thick ones as tubes", () => {
    const { thick, lines } = thickest(treeOf(chain([9, 8, 1, 7, 2, 6])), 3);
    assert.deepEqual(thick, [1, 3]); // the root, 9, is the third, and has no segment
    assert.deepEqual([...lines], [1, 2, 3, 4, 4, 5]);
});

test("segments of equal thickness do not exceed the maximum number of tubes", () => {
    const { thick, lines } = thickest(treeOf(chain(new Array(10).fill(1))), 4);
    assert.equal(thick.length, 4);
    assert.equal(lines.length, 2 * 5);
});

test("small trees are drawn with tubes only", () => {
    const { thick, lines } = thickest(treeOf(chain([3, 2, 1])), 100);
    assert.deepEqual(thick, [1, 2]);
    assert.equal(lines.length, 0);
});
