// Values of colours, legends and isolines.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Geometry } from "../src/app";
import type { GeometryHeader } from "../src/protocol";
import { legendTicks } from "../src/panels/display/legends";
import { extentAlong, slicedSolid } from "../src/panels/display/cuts";
import { createStore } from "../src/store";
import { colorOf, paint } from "../src/view/colors";
import { isolines, isoLevels } from "../src/view/isolines";
import { lengthText, roundBelow, shortNumber, ticks } from "../src/view/lengths";
import { rangeOf, union } from "../src/view/values";

function geometry(arrays: Geometry["arrays"], header: Partial<GeometryHeader> = {}): Geometry {
    const full = { kind: "surface", object: { kind: "skeleton", name: "tree" }, version: 1, origin: [0, 0, 0], arrays: [], ...header };
    return { header: full as GeometryHeader, arrays };
}

test("numbers are short, and lengths have a suitable unit", () => {
    assert.equal(shortNumber(3.14159), "3.14");
    assert.equal(shortNumber(1200), "1200");
    assert.equal(shortNumber(0.5000001), "0.5");
    assert.equal(shortNumber(-0.25), "−0.25");
    assert.equal(shortNumber(-0.0), "0");
    assert.equal(shortNumber(0.00001234), "1.23e−5");
    assert.equal(shortNumber(NaN), "–");
    assert.equal(lengthText(2.5), "2.5 m");
    assert.equal(lengthText(0.034), "3.4 cm");
    assert.equal(lengthText(0.0042), "4.2 mm");
    assert.equal(lengthText(12345), "12.3 km");
    assert.equal(lengthText(-0.5), "−50 cm");
    assert.equal(lengthText(0), "0 m");
});

test("ticks are round numbers inside the range, and of limited number", () => {
    assert.deepEqual(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
    assert.deepEqual(ticks(0.013, 0.268, 4), [0.1, 0.2]);
    assert.deepEqual(ticks(-0.3, 0.3, 3), [-0.2, 0, 0.2]);
    assert.deepEqual(ticks(1, 1, 4), []);
    assert.equal(roundBelow(7.3), 5);
    assert.equal(roundBelow(0.19), 0.1);
    assert.equal(roundBelow(2), 2);
});

test("a legend labels its ends, and ticks between them if there is room", () => {
    const named = legendTicks({ low: 0, high: 0.771 });
    assert.deepEqual(
        named.map(({ text }) => text),
        ["0", "0.2", "0.4", "0.771"],
    );
    assert.deepEqual([named[0].at, named.at(-1)?.at], [0, 1]);
    assert.deepEqual(legendTicks({ low: 2, high: 2 }), [{ at: 0.5, text: "2" }]);
});

test("colours cover the whole map, and those of deviations are symmetric about 0", () => {
    assert.deepEqual(colorOf(0), [68, 1, 84]);
    assert.deepEqual(colorOf(2), [253, 231, 37]);
    const [red, , blue] = colorOf(0, "diverging");
    assert.ok(blue > red); // blue is inside
    const middle = colorOf(0.5, "diverging");
    assert.ok(Math.max(...middle) - Math.min(...middle) < 10);
    // Values beyond the range have the colours of its ends.
    const colors = paint(new Float32Array([-5, 0, 1, 5]), { low: 0, high: 1 });
    assert.deepEqual([...colors.subarray(0, 4)], [...colors.subarray(4, 8)]);
    assert.deepEqual([...colors.subarray(8, 12)], [...colors.subarray(12, 16)]);
});

test("ranges cover the values, 0 to 1 for shares, and are symmetric for deviations", () => {
    const value = Float32Array.from({ length: 1000 }, (_, i) => (i === 999 ? 50 : (i % 100) / 1000));
    const deviation = rangeOf(geometry({ value }, { color: "deviation" }), "deviation");
    assert.equal(deviation?.low, -(deviation?.high ?? 0));
    assert.ok((deviation?.high ?? 1) < 0.1); // 98 of 100 are below 0.098; the outlier is ignored
    assert.deepEqual(rangeOf(geometry({ value }, { color: "evidence" }), "evidence"), { low: 0, high: 1 });
    assert.equal(rangeOf(geometry({ value }, { color: "radius" }), "evidence"), null); // values of another colouring
    const axes = geometry({ radius: new Float32Array([0.25, 0.5]), order: new Uint8Array([0, 3]) });
    assert.deepEqual(rangeOf(axes, "radius"), { low: 0.25, high: 0.5 });
    assert.deepEqual(rangeOf(axes, "order"), { low: 0, high: 3 });
    assert.equal(rangeOf(axes, "plain"), null);
    assert.equal(rangeOf(axes, "deviation"), null);
    assert.deepEqual(union({ low: 0, high: 1 }, { low: -1, high: 0.5 }), { low: -1, high: 1 });
    assert.deepEqual(union(null, { low: 1, high: 2 }), { low: 1, high: 2 });
});

test("a contour line of a slope is straight", () => {
    // 3 x 2 samples that increase by 1 with each column: the value 0.5 is at a quarter of the width.
    const ends = isolines({ value: new Float32Array([0, 1, 2, 0, 1, 2]), width: 3, height: 2 }, 0.5);
    assert.equal(ends.length, 4);
    assert.deepEqual(
        ends.filter((_, i) => i % 2 === 0),
        [0.25, 0.25],
    );
    assert.deepEqual(ends.filter((_, i) => i % 2 === 1).sort(), [0, 1]);
});

test("contour lines of a hill are closed", () => {
    const width = 21;
    const value = Float32Array.from({ length: width * width }, (_, i) => Math.hypot((i % width) - 10, Math.floor(i / width) - 10));
    const ends = isolines({ value, width, height: width }, 6.5);
    const met = new Map<string, number>();
    for (let i = 0; i < ends.length; i += 2) {
        const at = `${ends[i].toFixed(9)} ${ends[i + 1].toFixed(9)}`;
        met.set(at, (met.get(at) ?? 0) + 1);
        // Between samples the distance is not linear, so that end points are off by some hundredths of a step.
        assert.ok(Math.abs(Math.hypot(ends[i] * 20 - 10, ends[i + 1] * 20 - 10) - 6.5) < 0.1);
    }
    assert.ok(met.size > 30);
    assert.deepEqual([...new Set(met.values())], [2]); // each end point belongs to two segments
});

test("the value at the middle decides if two hills are joined at a corner", () => {
    const apart = isolines({ value: new Float32Array([1, 0, 0, 1]), width: 2, height: 2 }, 0.6);
    const joined = isolines({ value: new Float32Array([1, 0, 0, 1]), width: 2, height: 2 }, 0.4);
    assert.equal(apart.length, 8);
    assert.equal(joined.length, 8);
    // Separate: each segment cuts off the corner of a maximum, (0, 0) or (1, 1). Joined: the corner of a minimum, (1, 0) or (0,
    // 1).
    const onMain = (ends: number[]) => Math.abs((ends[0] + ends[2]) / 2 - (ends[1] + ends[3]) / 2) < 1e-9;
    assert.ok(onMain(apart.slice(0, 4)) && onMain(apart.slice(4)));
    assert.ok(!onMain(joined.slice(0, 4)) && !onMain(joined.slice(4)));
});

test("contour lines have round values other than that of the surface", () => {
    assert.deepEqual(isoLevels(0, 1, 0.4, 5), [0.2, 0.6, 0.8]);
    assert.deepEqual(isoLevels(0, 1, 0.5, 0), []);
});

test("planes are placed inside the objects, and the slice shows the selected solid", () => {
    const bounds = (at: number): [number, number, number, number, number, number] => [at, 0, 0, at + 1, 2, 3];
    assert.deepEqual(extentAlong([{ bounds: bounds(0) }, { bounds: bounds(5) }], "x"), [0, 6]);
    assert.deepEqual(extentAlong([{ bounds: [1, 1, 1, 0, 0, 0] }], "z"), [0, 1]); // empty bounds
    const store = createStore();
    const solid = (name: string) => ({ kind: "solid" as const, name, version: 1, statement: 0, bounds: bounds(0), count: 0, unit: "" });
    store.state.value = { ...store.state.peek(), objects: [solid("a"), solid("b"), solid("c")] };
    assert.equal(slicedSolid({ store }, "")?.name, "c");
    assert.equal(slicedSolid({ store }, "b")?.name, "b");
    store.selection.value = { object: { kind: "solid", name: "a" }, nodes: [], extent: "branch" };
    assert.equal(slicedSolid({ store }, "b")?.name, "a");
});
