// Gestures without a browser: results of drags and typed numbers, and the lines for them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bendTo, bentTip, leverOf } from "../src/tools/branch/bend_angle";
import { alongSegment } from "../src/tools/branch/host";
import { brushed, prunable, touched } from "../src/tools/branch/prune";
import { depthsOf, drawnBranch } from "../src/tools/branch/stroke";
import type { Point } from "../src/protocol";
import { branchLine, changeOf, objectLine, type Reading, turnAbout } from "../src/tools/kit/change";
import { Skeleton } from "../src/tools/kit/skeleton";
import { TypedInput, typedShift } from "../src/tools/kit/typed_input";
import { add, angleAbout, cross, distance, length, normalized, onLine, onPlane, rotated, roundStep, simplified, subtract } from "../src/tools/kit/vector";
import { commandLine, idSelection, numberWord, pointWord, quoted, sizeWord } from "../src/tools/kit/words";
import { nodesInBox, stepped } from "../src/tools/select";

const kNone = 0xffffffff;

// A stem of four nodes with a lateral of two from its second: ids are ten times the index.
function stem(): Skeleton {
    const position = [0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 1, 0, 1.5, 2, 0, 2];
    const radius = [0.2, 0.15, 0.12, 0.1, 0.05, 0.02];
    return new Skeleton(position, radius, [kNone, 0, 1, 2, 1, 4], [0, 10, 20, 30, 40, 50]);
}

const fromAbove = { toPixels: ([x, y, z]: Point): [number, number, number] => [x * 100, -z * 100, y / 100] };
const camera = { ...fromAbove, toPlane: (x: number, y: number, through: Point): Point => [x / 100, through[1], -y / 100] };

function key(text: string, shiftKey = false): KeyboardEvent {
    return { key: text, shiftKey, ctrlKey: false, metaKey: false, altKey: false } as KeyboardEvent;
}

function typing(...keys: string[]): TypedInput {
    const typed = new TypedInput();
    for (const text of keys) {
        assert.ok(typed.key(key(text.replace("Shift+", ""), text.startsWith("Shift+"))), text);
    }
    return typed;
}

test("numbers are rounded to the precision of the pointer", () => {
    assert.equal(numberWord(1.23456, 0.01), "1.23");
    assert.equal(numberWord(1.5, 0.0001), "1.5");
    assert.equal(numberWord(-0.00001, 0.001), "0");
    assert.equal(numberWord(1234.5, 10), "1235");
    assert.equal(numberWord(120, 1), "120");
    assert.equal(pointWord([1, -2.5, 1e-9], 0.001), "1,-2.5,0");
    assert.ok(Number(sizeWord(1e-6, 0.1)) > 0);
});

test("words are quoted according to the syntax of scenes", () => {
    assert.equal(quoted("crown"), "crown");
    assert.equal(quoted("my tree.glb"), '"my tree.glb"');
    assert.equal(quoted("a=b"), '"a=b"');
    assert.equal(quoted('say "x"\\'), '"say \\"x\\"\\\\"');
    assert.equal(quoted("${x}"), "$${x}");
    assert.equal(commandLine(["edit", "delete", "tree", "tips & order(1)"], { alone: true, x: undefined }), 'edit delete tree "tips & order(1)" alone=true');
});

test("selections by ids are written as short ranges", () => {
    assert.equal(idSelection([7]), "7");
    assert.equal(idSelection([5, 3, 4, 9, 9]), "id(3-5,9)");
});

test("typed values constrain the gesture and override the drag", () => {
    assert.deepEqual(typing("x", "2", ".", "5").values(), [2.5]);
    assert.deepEqual(typedShift(typing("z", "2")), [0, 0, 2]);
    assert.deepEqual(typedShift(typing("1", ",", "0", ",", "3", "-")), [1, 0, -3]);
    assert.deepEqual(typing("Shift+z").constrain([1, 2, 3]), [1, 2, 0]);
    assert.deepEqual(typing("y").constrain([1, 2, 3]), [0, 2, 0]);
    assert.equal(typing("x", "x").axis, null);
    assert.equal(typing("1", "Backspace").values(), null);
});

test("drags are converted to changes", () => {
    const reading = (mode: Reading["mode"], typed = new TypedInput(), snap = false): Reading => ({
        mode,
        typed,
        evenly: false,
        sight: [0, 1, 0],
        snap,
        grid: 0.5,
    });
    const dragged = { by: [0.6, 0, 1.2] as Point, turn: 32, factor: 1.27 };
    assert.deepEqual(changeOf(dragged, reading("move", new TypedInput(), true)), { mode: "move", by: [0.5, 0, 1] });
    assert.deepEqual(changeOf(dragged, reading("move", typing("x"))), { mode: "move", by: [0.6, 0, 0] });
    assert.equal((changeOf(dragged, reading("turn")) as { degrees: number }).degrees, 32);
    assert.deepEqual((changeOf(dragged, reading("turn", typing("y"))) as { axis: Point }).axis, [0, 1, 0]);
    assert.equal((changeOf(dragged, reading("turn", typing("y", "4", "5"))) as { degrees: number }).degrees, 45);
    assert.deepEqual((changeOf(dragged, reading("size", typing("z", "2"))) as { factors: Point }).factors, [1, 1, 2]);
    assert.deepEqual((changeOf(dragged, reading("size", typing("Shift+z", "2"))) as { factors: Point }).factors, [2, 2, 1]);
});

test("rings rotate with the drag, seen from the front or edge-on", () => {
    const into: Point = [0, 1, 0]; // the camera looks along Y from y = -10
    const ray = (x: number, z: number) => ({ origin: [x, -10, z] as Point, direction: into });
    const turn = (axis: Point, from: [number, number], to: [number, number]) => turnAbout(axis, [0, 0, 0], ray(...from), ray(...to), into, 2);
    // Seen from the camera Y points away: from the right to the top is clockwise about it, and so -90 degrees.
    assert.ok(Math.abs(turn([0, 1, 0], [1, 0], [0, 1]) + 90) < 1e-9);
    assert.ok(Math.abs(turn([0, -1, 0], [1, 0], [0, 1]) - 90) < 1e-9);
    // The ring about Z is seen edge-on; its near side moves to the right, 1 m of a circle with 2 m radius.
    assert.ok(Math.abs(turn([0, 0, 1], [0, 0], [1, 0]) - (0.5 * 180) / Math.PI) < 1e-9);
});

test("lines contain the kind of an object if its name is ambiguous", () => {
    const objects = [
        { kind: "solid", name: "a" },
        { kind: "skeleton", name: "a" },
        { kind: "solid", name: "b" },
    ];
    const app = { store: { state: { peek: () => ({ objects }) } } } as unknown as Parameters<typeof objectLine>[0];
    assert.equal(objectLine(app, { kind: "solid", name: "b" }, { mode: "move", by: [0.123456, 0, 2] }, [0, 0, 0], 0.01), "translate b 0.12 0 2");
    assert.equal(
        objectLine(app, { kind: "skeleton", name: "a" }, { mode: "turn", axis: [0, 0, 1], degrees: 30 }, [1, 2, 3], 0.01),
        "rotate a 30 center=1,2,3 kind=skeleton",
    );
    assert.equal(objectLine(app, { kind: "solid", name: "b" }, { mode: "size", factors: [2, 2, 2] }, [0, 0, 1], 0.01), "scale b 2 center=0,0,1");
    assert.equal(branchLine("t", "12", false, { mode: "turn", axis: [1, 0, 0], degrees: 9 }, 0.01), "edit rotate t 12 9 axis=1,0,0");
    assert.equal(branchLine("t", "12", true, { mode: "move", by: [1, 0, 0] }, 0.01), "edit move t 12 by=1,0,0");
});

test("rays intersect planes and lines", () => {
    const ray = { origin: [0, -5, 1] as Point, direction: [0, 1, 0] as Point };
    assert.deepEqual(onPlane(ray, [0, 2, 0], [0, 1, 0]), [0, 2, 1]);
    assert.equal(onPlane(ray, [0, 2, 0], [0, 0, 1]), null);
    assert.equal(onPlane(ray, [0, -9, 0], [0, 1, 0]), null);
    assert.ok(Math.abs((onLine(ray, [0, 0, 0], [0, 0, 1]) ?? 0) - 1) < 1e-12);
    assert.equal(onLine(ray, [1, 0, 0], [0, 1, 0]), null);
    assert.ok(Math.abs(angleAbout([1, 0, 5], [0, 1, -3], [0, 0, 1]) - Math.PI / 2) < 1e-12);
    assert.ok(distance(rotated([1, 0, 0], [0, 0, 1], Math.PI / 2), [0, 1, 0]) < 1e-12);
});

test("snapping steps are round numbers", () => {
    assert.deepEqual(
        [0.013, 0.2, 0.21, 3, 9].map((least) => Number(roundStep(least).toPrecision(6))),
        [0.02, 0.2, 0.5, 5, 10],
    );
});

test("an axis bends until its tip is at the pointer", () => {
    const chain: Point[] = Array.from({ length: 12 }, (_, i) => [0, 0.02 * Math.sin(i), i / 4]);
    for (const degrees of [10, 45, 100]) {
        for (const towards of [
            [1, 0, 0],
            [0.3, -1, 0.2],
            [-1, 1, -0.4],
        ] as Point[]) {
            const first = normalized(subtract(chain[1], chain[0]));
            const tip = bentTip(chain, normalized(cross(first, towards)), (degrees * Math.PI) / 180);
            const found = bendTo(chain, tip);
            const again = bentTip(chain, normalized(cross(first, found.towards)), (found.degrees * Math.PI) / 180);
            assert.ok(distance(again, tip) < 0.03, `${degrees} towards ${towards}: ${distance(again, tip)}`);
            assert.ok(Math.abs(found.degrees - degrees) < 3, `${found.degrees} instead of ${degrees}`);
        }
    }
});

test("an axis bends until the held node is at the pointer", () => {
    const chain: Point[] = Array.from({ length: 11 }, (_, i) => [0, 0, i / 10]);
    const middle = bentTip(chain, [0, 1, 0], Math.PI / 3, 5);
    const found = bendTo(chain, middle, 5);
    // The direction of the drag is not exactly X, but the plane and the angle are the same.
    assert.ok(Math.abs(found.degrees - 60) < 0.1, `${found.degrees}`);
    // 0.3 of the length is the minimum lever: its third edge.
    assert.deepEqual([leverOf(chain, 1), leverOf(chain, 7)], [3, 7]);
});

test("selections have a center and an extent", () => {
    const tree = stem();
    assert.deepEqual(tree.extended(2, "node"), [2]);
    assert.deepEqual(tree.extended(2, "branch"), [0, 1, 2, 3]);
    assert.deepEqual(tree.extended(4, "branch"), [4, 5]);
    assert.deepEqual(tree.extended(1, "subtree").sort(), [1, 2, 3, 4, 5]);
    assert.deepEqual(tree.extended(5, "tree").sort(), [0, 1, 2, 3, 4, 5]);
    assert.deepEqual(tree.extended(3, "connected"), [2, 3]);
    assert.deepEqual(tree.selected([50, 999], "branch"), [4, 5]);
    assert.deepEqual(tree.highest([2, 3, 5, 4]), [2, 4]);
    assert.deepEqual(tree.grown([4]).sort(), [1, 4, 5]);
    assert.deepEqual(tree.shrunk([0, 1, 2, 4]), [0, 1]);
    assert.equal(tree.axisStart(3), 0);
    assert.ok(Math.abs(tree.lengthFrom(4) - 2 * Math.hypot(1, 0.5)) < 1e-12);
});

test("arrow keys move the selection along the tree", () => {
    const tree = stem();
    assert.equal(stepped(tree, 1, "child"), 2);
    assert.equal(stepped(tree, 2, "after"), 4);
    assert.equal(stepped(tree, 2, "before"), 4);
    assert.equal(stepped(tree, 0, "parent"), 0);
    assert.equal(stepped(tree, 5, "child"), 5);
});

test("boxes and brushes select the nodes inside them", () => {
    const tree = stem();
    assert.deepEqual(nodesInBox(tree, [90, -140, 250, -250], fromAbove.toPixels), [4, 5]);
    assert.deepEqual(tree.nearest(150, -175, fromAbove.toPixels)?.node, 5);
    assert.equal(tree.nearest(500, 500, fromAbove.toPixels, 20), null);
    const pixels = tree.all().map((n) => fromAbove.toPixels(tree.at(n)));
    assert.deepEqual(touched(tree, pixels, 200, -200, 10), [5]);
    assert.deepEqual(touched(tree, pixels, 0, -100, 5), [1]);
});

test("a brush removes tips, but no branch that carries remaining nodes", () => {
    const tree = stem();
    assert.deepEqual(prunable(tree, new Set([1])), []);
    assert.deepEqual(prunable(tree, new Set([4, 5])), [4]);
    assert.deepEqual(prunable(tree, new Set([1, 3, 5])), [3, 5]);
    assert.deepEqual(prunable(tree, new Set([0, 1, 2, 3, 4, 5])), [0]);
});

test("a fast brush selects all nodes along its path", () => {
    const places = brushed([0, 0], [100, 0], 24);
    assert.deepEqual(places.at(-1), [100, 0]);
    assert.ok(places.every(([x], i) => x - (i > 0 ? places[i - 1][0] : 0) <= 24));
    assert.deepEqual(brushed([5, 5], [5, 5], 24), [[5, 5]]); // a click paints too
});

test("a stroke has the depth of the surrounding branches", () => {
    // The same stem, and a bough 3 m behind it to the right, in the direction of the stroke.
    const position = [0, 0, 0, 0, 0, 1, 0, 0, 2, 3, 3, 2, 4, 3, 2];
    const tree = new Skeleton(position, [0.1, 0.1, 0.1, 0.05, 0.05], [kNone, 0, 1, 2, 3], [0, 1, 2, 3, 4]);
    const stroke: [number, number][] = Array.from({ length: 40 }, (_, i) => [i * 10, -150 - i]);
    const depths = depthsOf(stroke, [0, 0, 1.5], tree, camera);
    assert.equal(depths[0][1], 0);
    assert.ok(depths[39][1] > 2, `the end is ${depths[39][1]} deep`);
    const branch = drawnBranch(stroke, [0, 0, 1.5], tree, camera);
    assert.ok(branch);
    assert.deepEqual(branch[0], [0, 0, 1.5]);
    assert.ok(Math.abs(branch[branch.length - 1][0] - 3.9) < 1e-9);
    assert.equal(
        drawnBranch(
            [
                [0, 0],
                [2, 1],
            ],
            [0, 0, 0],
            tree,
            camera,
        ),
        null,
    );
});

test("simplified lines keep the necessary points", () => {
    const wave: [number, number][] = Array.from({ length: 101 }, (_, i) => [i, 20 * Math.sin(i / 16)]);
    const kept = simplified(wave, 0.5);
    assert.ok(kept.length > 8 && kept.length < 30, String(kept.length));
    assert.deepEqual(
        simplified(
            [
                [0, 0],
                [1, 0.1],
                [2, 0],
            ],
            0.5,
        ),
        [
            [0, 0],
            [2, 0],
        ],
    );
});

test("closest positions on segments are found", () => {
    const tree = stem();
    assert.equal(alongSegment(tree, 2, [5, 0, 1.25]), 0.25);
    assert.equal(alongSegment(tree, 0, [5, 0, 1.25]), 1);
    assert.ok(length(add([1, 0, 0], [0, 1, 0])) > 1.4);
});
