// State of the document in the page.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { ObjectName, SceneObject } from "../src/protocol";
import { createStore, kEmptyState } from "../src/store";

const kParts: ObjectName[] = [
    { kind: "solid", name: "a" },
    { kind: "solid", name: "b" },
];
const kWhole: ObjectName = { kind: "solid", name: "whole" };

function withObjects(...objects: ObjectName[]) {
    return { ...kEmptyState, objects: objects as SceneObject[] };
}

test("objects are hidden while their replacement exists", () => {
    const store = createStore();
    const hidden = () => [...store.hidden.peek()].sort();
    store.state.value = withObjects(...kParts);
    store.hideFor(kParts, kWhole); // the response may arrive before the state
    assert.deepEqual(hidden(), ["solid:a", "solid:b"]);
    store.state.value = withObjects(...kParts, kWhole);
    assert.deepEqual(hidden(), ["solid:a", "solid:b"]);
    store.state.value = withObjects(...kParts);
    assert.deepEqual(hidden(), [], "undo shows them");
    store.state.value = withObjects(...kParts, kWhole);
    assert.deepEqual(hidden(), ["solid:a", "solid:b"], "redo hides them");
});

test("objects hidden before remain hidden, and objects hidden in two steps are shown together", () => {
    const store = createStore();
    store.state.value = withObjects(...kParts, kWhole);
    store.hidden.value = new Set(["points:p"]);
    store.hideFor([kParts[0], { kind: "points", name: "p" }], kWhole);
    store.hideFor(kParts, kWhole);
    assert.deepEqual([...store.hidden.peek()].sort(), ["points:p", "solid:a", "solid:b"]);
    store.state.value = withObjects(...kParts);
    assert.deepEqual([...store.hidden.peek()], ["points:p"]);
});
