// Crown tools without a browser: lines of primitives, combinations and warps; statements read and written back.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Point, State } from "../src/protocol";
import { kEmptyState } from "../src/store";
import { combineLine, gather } from "../src/tools/crown/combine";
import { curveLine } from "../src/tools/crown/curve";
import { loftLine, type Loft } from "../src/tools/crown/loft";
import { primitiveLine } from "../src/tools/crown/place";
import { framing, outlineLine, outlinePath, pieceAt, toPixel, toPlace, zoomed } from "../src/tools/crown/plane";
import { warpAxis, warpLine, warpOf } from "../src/tools/crown/warp";
import { controlsOf, documentText, findControls, wordsOf } from "../src/tools/kit/source";

test("primitives have the placed position and the drawn size", () => {
    const at: Point = [1, 2, 0];
    assert.equal(primitiveLine("sphere", "ball", at, 1.234, 2, 0.01), "sphere ball center=1,2,0 radius=1.23");
    assert.equal(primitiveLine("cylinder", "c", at, 1, 4, 0.01), "cylinder c from=1,2,0.1 to=1,2,3.9 skeleton_radius=0.9 radius=0.1");
    assert.equal(primitiveLine("box", "b", at, 1, 2, 0.01), "box b low=0.1,1.1,0.1 high=1.9,2.9,1.9 radius=0.1");
    assert.equal(primitiveLine("line", "l", at, 0.5, 3, 0.01), "line l from=1,2,0.5 to=1,2,2.5 radius=0.5");
    assert.equal(primitiveLine("cone", "k", at, 1, -2, 0.01), "cone k from=1,2,-1.9 to=1,2,-0.1 from_radius=0.9 radius=0.1");
});

test("a stroke selects each solid once", () => {
    const a = { kind: "solid" as const, name: "a" };
    const b = { kind: "solid" as const, name: "b" };
    const tree = { kind: "skeleton" as const, name: "tree" };
    const met = [undefined, a, a, undefined, tree, b, a].reduce(gather, [] as readonly { kind: "solid" | "skeleton"; name: string }[]);
    assert.deepEqual(
        met.map(({ name }) => name),
        ["a", "b"],
    );
    assert.equal(combineLine("ricci", ["a", "b"], "c", 4), "ricci a b c exponent=4");
    assert.equal(combineLine("diff", ["a", "b"], "c", 4), "diff a b c");
});

test("deformations follow their handle", () => {
    const [from, to] = warpAxis([-1, -1, 0, 1, 1, 4], "z");
    assert.deepEqual(
        [from, to],
        [
            [0, 0, 0],
            [0, 0, 4],
        ],
    );
    assert.equal(warpLine("twist", "s", [from, to], { amount: 90, side: [1, 0, 0] }, true, 0.01), "twist s 22.5 origin=0,0,0");
    const bent = warpOf("bend", from, to, [4, 0, 1], 30);
    assert.ok(Math.abs(bent.amount - 90) < 1e-9);
    assert.equal(warpLine("bend", "s", [from, to], bent, true, 0.01), "bend s 90 side=1,0,0");
    assert.equal(warpLine("taper", "s", [from, to], { amount: 0.5, side: [1, 0, 0] }, false, 0.01), "taper s 0.5 from=0,0,0 to=0,0,4");
    assert.equal(warpOf("taper", from, to, [0, 0, 0], 0).amount, 1);
    assert.equal(warpOf("taper", from, to, [0, 0, 0], 1e6).amount, 100);
});

test("statements are parsed as in scenes", () => {
    assert.deepEqual(
        wordsOf('profile "vase" 0,0 1,0 closed=false # a vase')?.words.map(({ text }) => text),
        ["profile", "vase", "0,0", "1,0", "false"],
    );
    assert.equal(wordsOf("profile p 0,0 ${x},1 2,2"), null);
    assert.equal(wordsOf("for i in 1..3\n  sphere s${i}\nend"), null);
    const controls = controlsOf("path spine 0,0,0 0,0,2 \\\n 1,0,4 kind=natural # why", 3, ["path"]);
    assert.deepEqual(controls?.points, [
        [0, 0, 0],
        [0, 0, 2],
        [1, 0, 4],
    ]);
    assert.equal(
        controls &&
            curveLine(
                "spine",
                controls,
                [
                    [0, 0, 0],
                    [0, 0.123, 2],
                ],
                0.01,
            ),
        "path spine 0,0,0 0,0.12,2 kind=natural # why",
    );
    assert.equal(controlsOf("path spine 0,0,zero 1,1,1", 0, ["path"]), null);
    assert.equal(controlsOf("sphere s", 0, ["path"]), null);
});

const state: State = {
    ...kEmptyState,
    statements: [
        { text: "# a crown", line: 1, message: "" },
        { text: "path spine 0,0,0 \\\n  0,0,2", line: 3, message: "" },
        { text: "sphere s", line: 6, message: "" },
    ],
    ran: 3,
    objects: [{ kind: "path", name: "spine", version: 1, statement: 1, bounds: [0, 0, 0, 0, 0, 2], count: 2, unit: "points" }],
};

test("one statement of a document is replaced, and the others are unchanged", () => {
    assert.equal(findControls(state, { kind: "path", name: "spine" }, ["path"])?.statement, 1);
    assert.equal(findControls(state, { kind: "path", name: "other" }, ["path"]), null);
    assert.equal(documentText(state, new Map()), "# a crown\n\npath spine 0,0,0 \\\n  0,0,2\n\nsphere s\n");
    assert.equal(documentText(state, new Map([[1, "path spine 0,0,0 0,0,3"]])), "# a crown\n\npath spine 0,0,0 0,0,3\n\nsphere s\n");
});

test("a profile has a plane with two axes", () => {
    const plane = framing(
        [
            [0, 0],
            [1, 2],
        ],
        400,
        400,
    );
    const pixel = toPixel(plane, [0.5, 1]);
    assert.deepEqual(pixel.map(Math.round), [200, 200]);
    const [x, y] = toPlace(zoomed(plane, 120, 80, 3), 120, 80);
    const [x0, y0] = toPlace(plane, 120, 80);
    assert.ok(Math.hypot(x - x0, y - y0) < 1e-9);
    const square = [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
    ] as const;
    const unit = { scale: 100, left: 0, top: 100 };
    assert.equal(pieceAt(square, true, unit, 50, 101, 6), 1);
    assert.equal(pieceAt(square, true, unit, 1, 50, 6), 4);
    assert.equal(pieceAt(square, false, unit, 1, 50, 6), -1);
    assert.equal(
        outlinePath(
            [
                [0, 0],
                [1, 0],
            ],
            false,
            false,
            unit,
        ),
        "M0 100L100 100",
    );
});

test("outlines keep the options that the editor does not show", () => {
    const outline = {
        command: "profile",
        name: "p",
        points: [
            [0, 0],
            [1, 0],
            [1, 1],
        ],
        closed: false,
        kind: "polyline",
    } as const;
    assert.equal(outlineLine(outline, 0.01), "profile p 0,0 1,0 1,1 closed=false");
    assert.equal(
        outlineLine({ ...outline, kind: "natural", closed: true }, 0.01, { options: { add: "q", kind: "x" }, comment: "# c" }),
        "profile p 0,0 1,0 1,1 kind=natural add=q # c",
    );
});

test("revolutions, sweeps and skins are formatted as statements", () => {
    const loft: Loft = {
        method: "revolve",
        name: "r",
        profile: "p",
        path: "",
        sections: [],
        origin: [0, 0, 0],
        twist: 0,
        end: 1,
        blend: "linear",
    };
    assert.equal(loftLine(loft), "revolve r p");
    assert.equal(loftLine({ ...loft, method: "sweep" }), null);
    assert.equal(loftLine({ ...loft, method: "sweep", path: "s", end: 0.5, twist: 90 }), "sweep r p s twist=90 scale=0,1 scale=1,0.5");
    assert.equal(
        loftLine({
            ...loft,
            method: "skin",
            path: "s",
            sections: [
                ["p", 0],
                ["q", 1],
            ],
            blend: "cubic",
        }),
        "skin r s p@0 q@1 blend=cubic",
    );
});
