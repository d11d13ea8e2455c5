// Sketches without a browser: strokes, branches and views, and positions on the screen.
import assert from "node:assert/strict";
import { test } from "node:test";
import { kindOf, ofKind, rowsOf, rowsText } from "../src/sketch/forms";
import {
    addStroke,
    branchAt,
    branchCalled,
    canReconstruct,
    changeStroke,
    changeView,
    drawnStroke,
    emptySketch,
    insertPoint,
    levelIn,
    movePoint,
    type Pixel,
    readSketch,
    removeBranch,
    removePoint,
    removeView,
    renameBranch,
    setParent,
    setWidth,
    type Sketch,
    type Stroke,
    widthAt,
    writtenSketch,
} from "../src/sketch/model";
import { tapered } from "../src/sketch/pane";
import { edgesAt, fitted, gripAt, toPicture, toScreen, widthByEdge, zoomedAt } from "../src/sketch/screen";

const upright: Stroke = {
    points: [
        [400, 700],
        [400, 500],
        [410, 300],
    ],
    widths: [20, 12, 8],
};

function tree(): Sketch {
    let { sketch } = addStroke(emptySketch(), "front", upright, null);
    ({ sketch } = addStroke(sketch, "side", upright, "stem"));
    ({ sketch } = addStroke(
        sketch,
        "front",
        {
            points: [
                [405, 520],
                [500, 420],
            ],
        },
        "stem",
    ));
    return sketch;
}

test("strokes are added to the chosen branch if it has none in that view, otherwise to a new branch", () => {
    const sketch = tree();
    assert.deepEqual(
        sketch.branches.map(({ name, parent }) => [name, parent]),
        [
            ["stem", undefined],
            ["branch 1", "stem"],
        ],
    );
    assert.deepEqual(Object.keys(sketch.branches[0].strokes), ["front", "side"]);
    assert.ok(canReconstruct(sketch));
    assert.ok(!canReconstruct(emptySketch()));
    assert.equal(
        addStroke(
            sketch,
            "front",
            {
                points: [
                    [10, 10],
                    [20, 20],
                ],
            },
            null,
        ).sketch.branches[2].parent,
        undefined,
    );
});

test("drawn lines keep the necessary points with their widths", () => {
    const line = Array.from({ length: 60 }, (_, i) => [i * 5, 100 * Math.sin(i / 20)] as Pixel);
    const stroke = drawnStroke(
        line,
        line.map((_, i) => 20 - i / 6),
        0.7,
    );
    assert.ok(stroke && stroke.points.length > 3 && stroke.points.length < 40);
    assert.equal(stroke.widths?.length, stroke.points.length);
    assert.deepEqual(stroke.points[0], [0, 0]);
    assert.equal(
        drawnStroke(
            [
                [0, 0],
                [1, 0],
            ],
            [2, 2],
            0.7,
        ),
        null,
    );
    assert.deepEqual(
        tapered({
            points: [
                [0, 0],
                [9, 9],
            ],
            widths: [8, 8],
        }).widths,
        [8, 4],
    );
    assert.deepEqual(
        tapered({
            points: [
                [0, 0],
                [9, 9],
            ],
            widths: [8, 3],
        }).widths,
        [8, 3],
    );
});

test("points are moved, added and removed with their widths", () => {
    assert.deepEqual(movePoint(upright, 1, [1, 2]).points[1], [1, 2]);
    assert.deepEqual(setWidth(upright, 1, 30).widths, [20, 30, 8]);
    const more = insertPoint(upright, 1, [400, 600]);
    assert.deepEqual(more.widths, [20, 16, 12, 8]);
    assert.deepEqual(more.points[1], [400, 600]);
    assert.deepEqual(removePoint(more, 1), upright);
    assert.equal(
        removePoint(
            {
                points: [
                    [0, 0],
                    [1, 1],
                ],
            },
            0,
        ),
        null,
    );
    assert.equal(widthAt({ points: upright.points, widths: [20, 10] }, 1), 15);
});

test("branches are renamed, moved to another parent and deleted", () => {
    const sketch = tree();
    const named = renameBranch(sketch, "stem", "trunk");
    assert.equal(branchCalled(named, "branch 1")?.parent, "trunk");
    assert.equal(renameBranch(sketch, "stem", "branch 1"), sketch);
    assert.equal(renameBranch(sketch, "stem", " "), sketch);
    assert.equal(setParent(sketch, "stem", "branch 1"), sketch);
    assert.equal(branchCalled(setParent(sketch, "branch 1", null), "branch 1")?.parent, undefined);
    assert.equal(branchCalled(removeBranch(sketch, "stem"), "branch 1")?.parent, undefined);
    const bare = changeStroke(sketch, "branch 1", "front", () => null);
    assert.deepEqual(
        writtenSketch(bare).branches.map(({ name }) => name),
        ["stem"],
    );
});

test("views are removed with their strokes", () => {
    const sketch = tree();
    const named = changeView(sketch, 0, { ...sketch.views[0], name: "north" });
    assert.deepEqual(Object.keys(named.branches[0].strokes).sort(), ["north", "side"]);
    assert.deepEqual(Object.keys(removeView(sketch, 1).branches[0].strokes), ["front"]);
    assert.deepEqual(readSketch(JSON.stringify(sketch)), sketch);
    assert.throws(() => readSketch('{"format": "else"}'), /no sketch/);
});

test("kinds of views have the fields that the engine requires", () => {
    const view = { ...emptySketch().views[0], image: "a.png" };
    for (const kind of ["drawing", "photograph", "calibrated", "colmap", "turntable"] as const) {
        const changed = ofKind(view, kind);
        assert.equal(kindOf(changed), kind);
        assert.equal(changed.image, "a.png");
        assert.equal(changed.name, "front");
    }
    assert.deepEqual(rowsOf("1 0 0; 0, 1, 0"), [
        [1, 0, 0],
        [0, 1, 0],
    ]);
    assert.equal(rowsOf("1 x"), null);
    assert.equal(
        rowsText([
            [1, 2],
            [3, 4],
        ]),
        "1 2; 3 4",
    );
});

test("drawings to scale have a common height", () => {
    const [front, side] = emptySketch().views;
    assert.equal(levelIn(front, { ...side, pixels_per_metre: 50, origin: [100, 400] }, [3, 600]), 350);
    assert.equal(levelIn(front, { ...side, orthographic: "top" }, [3, 600]), null);
});

test("pictures are fitted into panes", () => {
    const screen = fitted(800, 400, 400, 400);
    assert.deepEqual(toScreen(screen, [800, 400]), [400, 300]);
    assert.deepEqual(toPicture(screen, 400, 300), [800, 400]);
    const near = zoomedAt(screen, 100, 150, 4);
    assert.deepEqual(toPicture(near, 100, 150), toPicture(screen, 100, 150));
    const one = { scale: 1, x: 0, y: 0 };
    assert.deepEqual(gripAt(upright, one, 401, 699, 10), { part: "point", index: 0, far: Math.hypot(1, 1) });
    const [left] = edgesAt(upright, 1);
    assert.equal(gripAt({ ...upright, widths: [20, 60, 8] }, one, 430, 500, 10)?.part, "edge");
    assert.ok(Math.abs(Math.hypot(left[0] - 400, left[1] - 500) - 6) < 1e-9);
    assert.ok(Math.abs(widthByEdge(upright, 0, [415, 640]) - 30) < 1e-9);
    assert.equal(branchAt(tree(), "front", [402, 600], 10)?.name, "stem");
    assert.equal(branchAt(tree(), "front", [300, 600], 10), null);
});
