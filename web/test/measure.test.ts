// Measures of picked points as text.
import assert from "node:assert/strict";
import { test } from "node:test";
import { angleAt, degreesText, type Measure, measureText, radiusAt, spotText } from "../src/tools/measure_text";

test("a point is measured by its height and the radius of the branch", () => {
    assert.equal(spotText({ at: [0, 0, 1.25] }), "1.25 m above the ground");
    assert.equal(spotText({ at: [0, 0, -0.4] }), "40 cm below the ground");
    assert.equal(spotText({ at: [0, 0, 2], radius: 0.03, of: "node 7 of tree" }), "node 7 of tree: radius 3 cm, diameter 6 cm; 2 m above the ground");
});

test("two points are measured by their distance, three points by the angle at the second", () => {
    const two: Measure = [{ at: [0, 0, 0] }, { at: [3, 0, 4] }];
    assert.deepEqual(measureText(two), ["distance 5 m", "3 m across the ground, 4 m up"]);
    // From (3, 0, 4) back to the origin and straight down: the sides of a right triangle, so that the angle is atan(3 / 4).
    const three: Measure = [...two, { at: [3, 0, 0] }];
    assert.ok(Math.abs(angleAt(three) - Math.atan2(3, 4)) < 1e-12);
    assert.deepEqual(measureText(three).slice(2), ["distance 4 m", "angle 36.87°"]);
    assert.equal(degreesText(Math.PI / 2), "90°");
    assert.deepEqual(measureText([]), []);
});

test("the radius at a segment is interpolated between its ends", () => {
    const radius = (z: number) => radiusAt([0.3, 0, z], [0, 0, 1], [0, 0, 3], [0.2, 0.1]);
    assert.equal(radius(0), 0.2);
    assert.equal(radius(9), 0.1);
    assert.ok(Math.abs(radius(2) - 0.15) < 1e-12);
    assert.equal(radiusAt([0, 0, 0], [1, 1, 1], [1, 1, 1], [0.2, 0.1]), 0.1); // a segment of length zero
});
