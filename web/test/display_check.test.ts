// The figures of a check, in groups.
import assert from "node:assert/strict";
import { test } from "node:test";
import { checkedObject, isOf } from "../src/panels/display/checks";
import { crossingPlaces, grouped } from "../src/panels/display/figures";
import type { Kind, SceneObject } from "../src/protocol";
import { createStore } from "../src/store";

test("figures are grouped, bad values are marked, and missing values are omitted", () => {
    const groups = grouped({
        sound: false,
        open_edges: 4,
        quads_percent: 100,
        scaled_jacobian: { n: 10, p1: 0.5, min: 0.1 },
        intersections: { total: 0, local: 0 },
        volume: { ratio: 1.01 },
        something_new: 3,
    });
    assert.deepEqual(
        groups.map(({ title }) => title),
        ["Topology", "Crossings", "Shape of faces", "Size"],
    );
    const rows = groups.flatMap((group) => group.rows);
    assert.deepEqual(
        rows.filter((row) => row.isBad).map((row) => row.label),
        ["Sound", "Open edges"],
    );
    const quads = rows.find((row) => row.label === "Quads");
    assert.deepEqual([quads?.value, quads?.unit], [100, "%"]);
    assert.equal(rows.find((row) => row.label === "Volume ratio")?.value, 1.01);
    assert.equal(rows.length, 8);
});

test("places of crossings have the figures of the report", () => {
    const places = crossingPlaces({ crossing_place_1: { pairs: 7, radius: 0.02, x: 1 } }, [
        [1, 2, 3],
        [4, 5, 6],
    ]);
    assert.deepEqual(places, [
        { at: [1, 2, 3], radius: 0.02, pairs: 7 },
        { at: [4, 5, 6], radius: 0, pairs: 0 },
    ]);
});

function object(kind: Kind, name: string, statement: number): SceneObject {
    return { kind, name, version: 10 + statement, statement, bounds: [0, 0, 0, 1, 1, 1], count: 0, unit: "" };
}

test("a check uses the selected object, otherwise the newest mesh, otherwise the newest skeleton", () => {
    const store = createStore();
    const select = (kind: Kind, name: string) => {
        store.selection.value = { object: { kind, name }, nodes: [], extent: "branch" };
    };
    assert.equal(checkedObject({ store }), undefined);
    store.state.value = { ...store.state.peek(), objects: [object("skeleton", "b", 3), object("skeleton", "a", 1), object("solid", "s", 5)] };
    assert.equal(checkedObject({ store })?.name, "b");
    select("solid", "s");
    assert.equal(checkedObject({ store })?.name, "b");
    select("skeleton", "a");
    assert.equal(checkedObject({ store })?.name, "a");
    store.state.value = { ...store.state.peek(), objects: [...store.state.peek().objects, object("mesh", "m", 4)] };
    assert.equal(checkedObject({ store })?.name, "a");
    select("solid", "s");
    assert.equal(checkedObject({ store })?.name, "m");
});

test("a check is valid for one version of its object", () => {
    const tree = object("skeleton", "tree", 1);
    const check = { object: { kind: "skeleton" as const, name: "tree" }, version: 11, good: true, verdict: "", figures: {}, places: [] };
    assert.ok(isOf(check, tree));
    assert.ok(!isOf(check, { ...tree, version: 12 }));
    assert.ok(!isOf(check, { ...tree, name: "other" }));
    assert.ok(!isOf(null, tree));
});
