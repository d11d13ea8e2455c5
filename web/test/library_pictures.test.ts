// The library without a browser: silhouettes, filters, keys of the grid, and the line of a graft.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Geometry } from "../src/app";
import { type Branch, filtered, filterValues, kAll, lengthText, stepInGrid, tagsOf } from "../src/panels/library/filter";
import { branchStart } from "../src/panels/library/model";
import { silhouetteOf } from "../src/panels/library/silhouette";
import { hostAt } from "../src/tools/branch/host";
import { Skeleton } from "../src/tools/kit/skeleton";
import { graftLine } from "../src/tools/branch/library_graft";
import { previewLine } from "../src/tools/kit/naming";

const kNone = 0xffffffff;

function skeleton(position: number[], radius: number[], parent: number[]): Geometry {
    const header = { kind: "skeleton", object: { kind: "skeleton", name: "1" }, version: 0, origin: [0, 0, 0], arrays: [] } as Geometry["header"];
    return { header, arrays: { position: new Float32Array(position), radius: new Float32Array(radius), parent: new Uint32Array(parent) } };
}

test("a silhouette is drawn from the front, upright, and fills its square", () => {
    // 2 m up from the origin, then 1 m to +x; y is the line of sight.
    const { strokes } = silhouetteOf(skeleton([0, 5, 0, 0, -5, 2, 1, 3, 2], [0.01, 0.01, 0.01], [kNone, 0, 1]), 108);
    // (108 - 8) / 2 m: 50 px a metre; the width of 50 px is centred, (108 - 50) / 2 = 29, and heights go from 104 up to 4.
    assert.deepEqual(
        strokes.map(({ path }) => path),
        ["M29 104L29 4M29 4L79 4"],
    );
});

test("thick branches have wide strokes and are drawn first", () => {
    const { strokes } = silhouetteOf(skeleton([0, 0, 0, 0, 0, 1, 0, 0, 2], [0.2, 0.2, 0.01], [kNone, 0, 1]), 108);
    assert.equal(strokes.length, 2);
    // 0.4 m at 50 px a metre are 20 px; strokes come in steps of a factor of 1.5, so within a factor of sqrt(1.5).
    assert.ok(Math.abs(Math.log(strokes[0].width / 20)) <= Math.log(1.5) / 2 + 1e-9);
    assert.ok(strokes[0].width > strokes[1].width);
});

test("segments below the resolution are joined, and tips are always drawn", () => {
    const count = 1001;
    const position = Array.from({ length: count }, (_, i) => [0, 0, i / 1000]).flat();
    const silhouette = silhouetteOf(
        skeleton(
            position,
            Array(count).fill(0.001),
            Array.from({ length: count }, (_, i) => (i === 0 ? kNone : i - 1)),
        ),
        108,
    );
    const moves = silhouette.strokes.map(({ path }) => path.split("M").length - 1).reduce((a, b) => a + b, 0);
    assert.ok(moves <= 167 && moves >= 100, String(moves)); // 100 px in steps of 0.6 px at least
    assert.ok(silhouette.strokes.some(({ path }) => path.endsWith("L54 4"))); // the tip at the top
    assert.equal(silhouetteOf(skeleton([1, 1, 1], [0.1], [kNone]), 108).strokes.length, 0); // one node: no strokes, and no error
});

function branch(number: number, fields: Partial<Branch> = {}): Branch {
    return {
        number,
        source: "oak.swc",
        tags: [],
        leads: false,
        length: number,
        volume: 0,
        extent: 0,
        nodes: 9,
        tips: 10 - number,
        orders: 1,
        radius: 0.1,
        ...fields,
    };
}

test("filters are combined, and sorting puts the longest branch first", () => {
    const all = [branch(1, { tags: ["oak", "low"] }), branch(2, { tags: ["oak"] }), branch(3, { source: "ash.swc" })];
    const numbers = (filter: Partial<typeof kAll>, order: "number" | "length" | "tips" = "number") =>
        filtered(all, { ...kAll, ...filter }, order).map(({ number }) => number);
    assert.deepEqual(numbers({}), [1, 2, 3]);
    assert.deepEqual(numbers({}, "length"), [3, 2, 1]);
    assert.deepEqual(numbers({}, "tips"), [1, 2, 3]);
    assert.deepEqual(numbers({ text: "ASH" }), [3]);
    assert.deepEqual(numbers({ tag: "oak", least: 2 }), [2]);
    assert.deepEqual(numbers({ most: 2 }), [1, 2]);
    assert.deepEqual(tagsOf(all), ["low", "oak"]);
    assert.deepEqual(filterValues({ ...kAll, tag: "oak", least: 2 }), { tag: ["oak"], min_tree_length: ["2"] });
    assert.deepEqual(filterValues(kAll), {});
});

test("arrow keys do not leave the grid", () => {
    assert.equal(stepInGrid("ArrowRight", 0, 10, 3), 1);
    assert.equal(stepInGrid("ArrowDown", 1, 10, 3), 4);
    assert.equal(stepInGrid("ArrowUp", 1, 10, 3), 0);
    assert.equal(stepInGrid("ArrowDown", 8, 10, 3), 9);
    assert.equal(stepInGrid("End", 0, 10, 3), 9);
    assert.equal(stepInGrid("a", 0, 10, 3), null);
    assert.equal(stepInGrid("ArrowRight", 0, 0, 3), null);
});

test("lengths are formatted for readers", () => {
    assert.equal(lengthText(12.345), "12.3 m");
    assert.equal(lengthText(0.456), "46 cm");
});

test("a graft line has only the necessary options", () => {
    const line = (along: number, roll: number, size: number) => previewLine(graftLine({ file: "my oaks.branches", number: 12 }, "tree", 40, along, roll, size));
    assert.equal(line(1, 0, 1), 'library graft tree "my oaks.branches" 12 40');
    assert.equal(line(0.254, -30, 1.21), 'library graft tree "my oaks.branches" 12 40 along=0.25 roll=-30 scale=1.21');
});

test("a graft at the start of a segment uses its first node as host", () => {
    const tree = new Skeleton([0, 0, 0, 0, 0, 1], [0.1, 0.1], [kNone, 0], [0, 1]);
    assert.deepEqual(hostAt(tree, 1, 0.004), { n: 0, along: 1 });
    assert.deepEqual(hostAt(tree, 1, 0.3), { n: 1, along: 0.3 });
    assert.deepEqual(hostAt(tree, 0, 0), { n: 0, along: 0 }); // a root has no previous node
});

test("a branch of the library begins after a fork, for any picked node", () => {
    // A stem 0-1-2-3 with a lateral 4-5 from node 1.
    const tree = new Skeleton(Array(18).fill(0), Array(6).fill(0.1), [kNone, 0, 1, 2, 1, 4], [0, 1, 2, 3, 4, 5]);
    assert.equal(branchStart(tree, 5), 4);
    assert.equal(branchStart(tree, 3), 2);
    assert.equal(branchStart(tree, 1), 0);
});
