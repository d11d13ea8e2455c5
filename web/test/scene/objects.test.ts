// The tree of objects, the history, and initial values of forms.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { App } from "../../src/app";
import { setDefault } from "../../src/panels/scene/defaults";
import { searched } from "../../src/panels/scene/forms/chooser";
import { initialFields } from "../../src/panels/scene/forms/fields";
import { canShow, Form } from "../../src/panels/scene/forms/form";
import { tupleWord } from "../../src/panels/scene/forms/tuple_field";
import { changesOf } from "../../src/panels/scene/history/model";
import { refusal } from "../../src/panels/scene/objects/actions";
import { consumers, found, rowsOf } from "../../src/panels/scene/objects/model";
import { createStore } from "../../src/store";
import { called, schema, stateOf } from "./schema";

const text = "sphere a\nsphere b\nunion a b crown\nsphere c\npointset generate crown\n";
const state = stateOf(text, [
    ["solid:a", 0],
    ["solid:b", 1],
    ["solid:crown", 2],
    ["solid:c", 3],
    ["points:crown", 4],
]);

function drawn(closed: string[] = []): string[] {
    return rowsOf(state, schema, new Set(closed)).map(
        ({ level, label, open }) => `${"  ".repeat(level - 1)}${label}${open === null ? "" : open ? " v" : " >"}`,
    );
}

test("solids are listed below the solid that contains them", () => {
    assert.deepEqual(drawn(), ["Crown solids v", "  crown v", "    a", "    b", "  c", "Points v", "  crown"]);
    assert.deepEqual(drawn(["solid:crown"]), ["Crown solids v", "  crown >", "  c", "Points v", "  crown"]);
    assert.deepEqual(drawn(["solid"]), ["Crown solids >", "Points v", "  crown"]);
    const rows = rowsOf(state, schema, new Set());
    assert.deepEqual(
        rows.map(({ position, size }) => `${position}/${size}`),
        ["1/2", "1/2", "1/2", "2/2", "2/2", "2/2", "1/1"],
    );
    assert.equal(rows[2].parent, "solid:crown");
    assert.equal(rows[2].detail, "3 parts");
});

test("solids that contain each other are listed without a cycle", () => {
    const mutual = stateOf("sphere a\nsphere b\nunion a b a\nunion a b b\n", [
        ["solid:a", 2],
        ["solid:b", 3],
    ]);
    assert.deepEqual([...consumers(mutual, schema)], [["b", "a"]]);
    const names = rowsOf(mutual, schema, new Set()).map(({ label }) => label);
    assert.deepEqual(names, ["Crown solids", "a", "b"]);
});

test("typed letters select the next object with this prefix", () => {
    const rows = rowsOf(state, schema, new Set());
    assert.equal(found(rows, 0, "c"), 1);
    assert.equal(found(rows, 1, "c"), 4);
    assert.equal(found(rows, 4, "cr"), 6);
    assert.equal(found(rows, 6, "a"), 2);
    assert.equal(found(rows, 0, "x"), -1);
});

test("existing and invalid names are rejected", () => {
    const store = createStore();
    store.state.value = state;
    const app = { store } as App;
    assert.equal(refusal(app, "a", "a"), "");
    assert.equal(refusal(app, "a", "top"), "");
    assert.match(refusal(app, "a", "crown"), /the name crown already/);
    assert.match(refusal(app, "a", "2a"), /letter/);
    assert.match(refusal(app, "a", "a b"), /letter/);
});

test("the history goes back and forward by counts", () => {
    assert.deepEqual(
        changesOf({ undo: ["one", "two"], redo: ["four", "three"] }).map(({ name, when, steps }) => `${name} ${when} ${steps}`),
        ["The beginning done -2", "one done -1", "two now 0", "three undone 1", "four undone 2"],
    );
    assert.deepEqual(
        changesOf({ undo: [], redo: ["one"] }).map(({ when }) => when),
        ["now", "undone"],
    );
    const many = Array.from({ length: 100 }, (_, i) => `line ${i}`);
    assert.equal(changesOf({ undo: many, redo: [] })[0].name, "line 0"); // earlier changes are unknown
});

test("commands are searched by name first", () => {
    assert.deepEqual(
        searched(schema, "gen").map(({ name }) => name),
        ["pointset generate"],
    );
    assert.equal(searched(schema, "trees")[0].name, "grow");
    assert.equal(searched(schema, "").length, schema.length);
    assert.deepEqual(
        initialFields(called("pointset generate"), { seed: ["1"] })
            .map(({ name }) => name)
            .includes("seed"),
        true,
    );
});

test("complete coordinates of a point are written as one word", () => {
    assert.equal(tupleWord(["1", "2", "3"], [3]), "1,2,3");
    assert.equal(tupleWord(["", "", "3"], [3]), "0,0,3");
    assert.equal(tupleWord(["2", "", ""], [3]), "2,0,0");
    assert.equal(tupleWord(["2", "x", ""], [3]), null);
    assert.equal(tupleWord(["2", "", ""], [1, 3]), "2");
    assert.equal(tupleWord(["2", "1", ""], [1, 3]), null);
    assert.equal(tupleWord(["2", "", "1"], [1, 3]), null);
    assert.equal(tupleWord(["", "", ""], [3]), null);
});

type SentRequest = Record<string, unknown>;

function appWith(requests: SentRequest[]): App {
    const store = createStore();
    store.state.value = { ...state, revision: 7 };
    store.schema.value = schema;
    store.connection.value = "ready";
    const note = <T>(one: SentRequest, reply: T) => {
        requests.push(one);
        return Promise.resolve(reply);
    };
    return {
        store,
        engine: {
            client: "me",
            request: (type: string, fields: Record<string, unknown>) => note({ type, ...fields }, {}),
            run: (line: string, about: unknown) => note({ type: "run", line, about }, { statement: 0, message: "" }),
            preview: (line: string, about: unknown) => note({ type: "preview", line, about }, true),
            endPreview: () => note({ type: "endpreview" }, undefined),
        },
    } as unknown as App;
}

test("a form has likely initial values and produces a line", async () => {
    const requests: SentRequest[] = [];
    const app = appWith(requests);
    app.store.selection.value = { object: { kind: "solid", name: "c" }, nodes: [], extent: "branch" };
    const form = new Form(app);
    form.begin(called("translate"));
    assert.deepEqual(
        form.missing.map(({ name }) => name),
        ["by"],
    );
    assert.equal(await form.run(), false);
    form.set("by", ["0,0,2"], false);
    assert.equal(form.line, "translate c 0,0,2");
    assert.equal(await form.run(), true);
    const about = { kind: "solid", name: "c" };
    assert.deepEqual(app.store.selection.peek().object, { kind: "solid", name: "a" }); // the object that the statement created, as reported by the engine
    assert.deepEqual(requests, [
        { type: "preview", line: "translate c 0,0,2", about },
        { type: "run", line: "translate c 0,0,2", about },
    ]);
    form.begin(called("sphere"));
    assert.equal(form.line, "sphere sphere");
});

test("forms have the default values of the menu", () => {
    const form = new Form(appWith([]));
    setDefault("sphere.radius", "3");
    form.begin(called("sphere"));
    assert.equal(form.line, "sphere sphere radius=3");
    setDefault("sphere.radius", null);
    form.begin(called("sphere"));
    assert.equal(form.line, "sphere sphere");
});

test("cancelling removes only the preview", () => {
    const requests: SentRequest[] = [];
    const form = new Form(appWith(requests));
    form.begin(called("sphere"));
    form.cancel();
    assert.deepEqual(requests, []);
    form.set("radius", ["2"], false);
    form.cancel();
    assert.deepEqual(
        requests.map(({ type }) => type),
        ["preview", "endpreview"],
    );
    assert.equal(canShow(called("grow")), false);
    assert.equal(canShow(called("save")), false);
    assert.equal(canShow(called("union")), true);
});

test("changed parameters of a statement are written to the text", async () => {
    const requests: SentRequest[] = [];
    const app = appWith(requests);
    const form = new Form(app);
    const object = { kind: "solid", name: "a" } as const;
    form.change(
        { command: called("sphere"), values: { name: ["a"] }, comment: "# one" },
        { statement: 0, text: "sphere a", comment: "# one", object, shows: true },
    );
    form.set("radius", ["2"], false);
    assert.deepEqual(requests, [{ type: "preview", line: "sphere a radius=2 # one", about: object }]);
    assert.equal(await form.run(), true);
    assert.deepEqual(requests[1], {
        type: "text",
        text: text.replace("sphere a", "sphere a radius=2 # one"),
        revision: 7,
        name: "parameters of a",
        joins: true,
    });
    // A text that was changed in between is not overwritten.
    app.store.state.value = stateOf(text.replace("sphere a", "sphere a law=soft"), []);
    form.set("radius", ["3"], false);
    assert.equal(await form.run(), false);
    assert.match(form.errorText.value, /changed in between/);
    assert.equal(requests.filter(({ type }) => type === "text").length, 1);
});
