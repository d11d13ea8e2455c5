// Growth without a browser: initial values, sliders, balls, lines of cards, and the result of a stopped growth.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type App, EngineError, type Geometry } from "../src/app";
import { countWithin, reachOf, rootsOf, samplesOf } from "../src/panels/grow/balls";
import { Card, creatorOf, targetOf } from "../src/panels/grow/card";
import { loadingCommands, scansAmong } from "../src/panels/grow/extraction";
import { GrowthWatch, optionOf } from "../src/panels/grow/growing";
import { finishing } from "../src/panels/grow/model";
import { growthValues, rootBelow, rounded, sliderOf, spacingIn, tipRadius } from "../src/panels/grow/suggest";
import type { Argument, Command, SceneObject, State } from "../src/protocol";
import { createStore, kEmptyState } from "../src/store";
import { GrowthPreview, pipeRadii } from "../src/view/growth_preview";
import { kDark } from "../src/view/theme";

function argument(name: string, fields: Partial<Argument> = {}): Argument {
    return { name, help: `${name} is`, type: "number", positional: false, required: false, repeats: false, ...fields };
}

const kGrow: Command = {
    name: "grow",
    aliases: [],
    group: "Trees",
    help: "Grow a tree into points.",
    example: "",
    arguments: [
        argument("tree", { type: "new_name", positional: true, required: true, help: "Name of the new skeleton." }),
        argument("points", { type: "object", kind: "points", positional: true, required: true }),
        argument("root", { type: "tuple", repeats: true, sizes: [3, 6] }),
        argument("influence_radius", { unit: "metre", low: 1e-6, high: 1e6, default: "1" }),
        argument("kill_radius", { unit: "metre", low: 1e-6, high: 1e6, default: "0.2" }),
        argument("step", { unit: "metre", low: 1e-6, high: 1e4, default: "0.1" }),
        argument("max_iterations", { type: "whole", low: 0, high: 1e9, default: "100000" }),
        argument("seed", { type: "whole", low: 0, high: 2147483647, default: "0" }),
    ],
};

const kGenerate: Command = {
    name: "pointset generate",
    aliases: ["pointset gen"],
    group: "Points",
    help: "Fill a solid.",
    example: "",
    arguments: [
        argument("solid", { type: "object", kind: "solid", positional: true, required: true }),
        argument("pattern", { type: "choice", positional: true, default: "poisson_disk", choices: ["poisson_disk", "uniform"] }),
        argument("count", { type: "whole", low: 0, high: 1e8, default: "1000" }),
        argument("name", { type: "new_name", default: "@solid", help: "Name of the new points." }),
    ],
};

const kThin: Command = {
    name: "pointset thin",
    aliases: [],
    group: "Points",
    help: "Remove points.",
    example: "",
    arguments: [
        argument("points", { type: "object", kind: "points", positional: true, required: true }),
        argument("percent", { positional: true, required: true, low: 0, high: 100 }),
    ],
};

function points(...at: [number, number, number][]): Geometry {
    const position = new Float32Array(at.flat());
    const header = { kind: "points", object: { kind: "points", name: "crown" }, version: 1, origin: [0, 0, 0], arrays: [] } as Geometry["header"];
    return { header, arrays: { position } };
}

test("a ball counts the points inside it, also with an origin of the blob", () => {
    const position = [0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3];
    assert.equal(countWithin(position, [0, 0, 0], [0, 0, 0], 2), 2); // the one at 2 is on it, not inside
    assert.equal(countWithin(position, [0, 0, 0], [0, 0, 0], 2.01), 3);
    assert.equal(countWithin(position, [10, 0, 0], [10, 0, 0], 1.5), 2);
    assert.equal(countWithin(position, [10, 0, 0], [0, 0, 0], 1.5), 0);
});

test("radii are drawn at the pointer, otherwise at the root", () => {
    const values = { root: ["0,0,0,0,0,1"], influence_radius: ["2.5"] };
    const set = points([0, 0, 0.1], [0, 0, 1], [0, 0, 2], [0, 0, 9]);
    assert.deepEqual(reachOf(set, kGrow, values, null), { at: "root", pulling: 3, removed: 1, all: 4 }); // the kill radius is 0.2
    assert.deepEqual(reachOf(set, kGrow, values, [0, 0, 9]), { at: "pointer", pulling: 1, removed: 1, all: 4 });
});

test("roots are parsed from words, and samples are distributed evenly", () => {
    assert.deepEqual(rootsOf({ root: ["1,2,3", "4,5,6,0,0,1"] }), [
        [1, 2, 3],
        [4, 5, 6],
    ]);
    assert.deepEqual(rootsOf({}), [[0, 0, 0]]);
    assert.deepEqual(rootsOf({ root: ["${x},0,0"] }), []);
    const position = Array.from({ length: 30 }, (_, i) => i); // ten points
    assert.deepEqual(samplesOf(position, [0, 0, 100], 2), [
        [6, 7, 108],
        [21, 22, 123],
    ]); // points 2 and 7
    assert.equal(samplesOf([1, 2, 3], [0, 0, 0], 3).length, 1);
});

test("radii are proposed from the distance of the points", () => {
    const bounds: SceneObject["bounds"] = [-3, -3, 2, 3, 3, 8];
    const spacing = spacingIn(bounds, 2000);
    assert.ok(Math.abs(spacing - Math.cbrt((Math.PI * 36) / 2000)) < 1e-9); // a ball of radius 3 has 36 pi cubic metres
    const values = growthValues(bounds, 2000);
    const [influence, kill, step] = ["influence_radius", "kill_radius", "step"].map((name) => Number(values[name][0]));
    assert.ok(step < kill && kill < influence); // order required by grow
    assert.equal(influence, rounded(4 * spacing));
    assert.deepEqual(values.root, ["0,0,0"]); // on the ground
    assert.deepEqual(rootBelow([-1, -1, -1, 1, 1, 1]), [0, 0, -1]); // a crown that extends below the ground: at its base
    assert.deepEqual(rootBelow([1, 2, 4, 3, 4, 6]), [2, 3, 0]);
});

test("a grown tree gets radii and is smoothed; a tree by rules keeps its angles", () => {
    assert.deepEqual(finishing(kGrow, { tree: ["oak"], step: ["0.11"] }), ["radii oak tip_radius=0.01", "tidy oak"]);
    const sprout = { ...kGrow, name: "sprout", arguments: [argument("tree"), argument("internode", { default: "0.12" })] };
    assert.deepEqual(finishing(sprout, { tree: ["birch"] }), ["radii birch tip_radius=0.006"]);
    assert.equal(tipRadius(0.22), 0.02);
});

test("slider positions and values are inverse, with a logarithmic scale for wide ranges", () => {
    const share = sliderOf(argument("probability", { low: 0, high: 1 }), 0.5);
    assert.ok(share);
    assert.equal(share.toValue(share.toStep(0.37)), 0.37);
    assert.equal(share.toValue(0), 0);
    assert.equal(share.toValue(share.steps), 1);
    const part = sliderOf(argument("tolerance", { low: 0, high: 100 }), 0.5); // a linear one would begin with steps of 0.5
    assert.ok(part);
    assert.equal(part.toValue(0), 0);
    assert.ok(part.toValue(part.steps) === 10 && part.toValue(5) < 0.05);
    const reach = sliderOf(argument("influence_radius", { low: 1e-6, high: 1e6 }), 2);
    assert.ok(reach);
    assert.equal(reach.toValue(0), 0.1); // a twentieth
    assert.equal(reach.toValue(reach.steps), 40); // twenty times
    for (const value of [0.1, 1, 2, 39]) {
        assert.ok(Math.abs(reach.toValue(reach.toStep(value)) / value - 1) < 0.02, String(value));
    }
    const count = sliderOf(argument("count", { type: "whole", low: 0, high: 1e8 }), 2000);
    assert.ok(count);
    assert.equal(count.toValue(0), 0);
    assert.equal(count.toValue(1), 100);
    assert.equal(count.toStep(0), 0);
    assert.ok(Number.isInteger(count.toValue(77)));
    assert.equal(sliderOf(argument("seed", { type: "whole", low: 0, high: 2147483647 }), 1), null);
});

test("the option that stops growth is parsed", () => {
    assert.deepEqual(optionOf("max_iterations=57"), { name: "max_iterations", value: "57" });
});

test("radii of growing trees follow the pipe model", () => {
    const kNone = 0xffffffff;
    // A stem of two nodes with two tips: 2 to the power of 1 / 2.5 at the fork and below.
    const radii = pipeRadii(new Uint32Array([kNone, 0, 1, 1]), new Float32Array(4).fill(0.01));
    const fork = 0.01 * 2 ** 0.4;
    [fork, fork, 0.01, 0.01].forEach((radius, n) => assert.ok(Math.abs(radii[n] - radius) < 1e-6, String(n)));
});

test("files of scans are detected by their endings and loaded with matching options", () => {
    assert.deepEqual(scansAmong(["a.swc", "b.PLY", "c.laz", "d.branches", "e.glb", "f.xyz"]), ["b.PLY", "c.laz", "e.glb", "f.xyz"]);
    assert.deepEqual(
        loadingCommands("x.ply").map(({ kind }) => kind),
        ["mesh", "points"],
    );
    assert.deepEqual(
        loadingCommands("x.obj").map(({ command }) => command),
        ["loadmesh"],
    );
    assert.deepEqual(loadingCommands("x.las"), []);
});

function state(...texts: string[]): State {
    return { ...kEmptyState, statements: texts.map((text, i) => ({ text, line: i + 1, message: "" })), ran: texts.length };
}

const tree: SceneObject = { kind: "skeleton", name: "tree", version: 1, statement: 3, bounds: [0, 0, 0, 1, 1, 1], count: 9, unit: "nodes" };

test("the statement that created an object is found before those that changed it", () => {
    const document = state("sphere crown", "pointset gen crown uni name=marks", "grow tree marks step=0.2 # slow", "radii tree");
    const creator = creatorOf(document, [kGrow, kGenerate], tree, ["grow", "sprout"]);
    assert.equal(creator?.bound.statement, 2);
    assert.deepEqual(creator?.values, { tree: ["tree"], points: ["marks"], step: ["0.2"] });
    assert.equal(creator?.bound.comment, "# slow");
    const marks: SceneObject = { ...tree, kind: "points", name: "marks", statement: 1 };
    assert.deepEqual(creatorOf(document, [kGrow, kGenerate], marks, ["pointset generate"])?.values.pattern, ["uniform"]);
    assert.equal(creatorOf(document, [kGrow, kGenerate], { ...tree, name: "other" }, ["grow"]), null);
    assert.deepEqual(targetOf(kGenerate, { solid: ["crown"] }), { kind: "points", name: "crown" }); // points have the name of their solid
});

// An engine that records its requests.
function pageWith(document: State, run?: (text: string) => Promise<void>) {
    const store = createStore();
    store.schema.value = [kGrow, kGenerate, kThin];
    store.state.value = document;
    const requests: string[] = [];
    const append = async (line: string, about?: { name: string }) => {
        requests.push(`run ${line}${about ? ` about ${about.name}` : ""}`);
        await run?.(line);
        const { statements } = store.state.peek();
        store.state.value = state(...statements.map(({ text }) => text), ...line.split("\n"));
        return { statement: 0, message: "" };
    };
    const engine = {
        run: append,
        preview: (line: string, about?: { name: string }) => {
            requests.push(`preview ${line}${about ? ` about ${about.name}` : ""}`);
            return Promise.resolve(true);
        },
        endPreview: () => {
            requests.push("end");
            return Promise.resolve();
        },
        request: async (type: string, fields: { text: string }) => {
            requests.push(`${type} ${fields.text.trimEnd().replaceAll("\n", "; ")}`);
            await run?.(fields.text);
            store.state.value = state(...fields.text.trimEnd().split("\n"));
            return {};
        },
    };
    return { app: { store, engine } as unknown as App, requests, store };
}

function growCard(app: App, watch?: GrowthWatch): Card {
    const card: Card = new Card(app, {
        commands: ["grow"],
        suggest: () => ({ tree: ["tree"], points: ["crown"], step: ["0.2"] }),
        shows: true,
        also: () => ["radii tree"],
        perform: watch && ((text, bound, target) => watch.perform(text, bound, target)),
        stopped: watch && (() => watch.stopped()),
    });
    card.renew();
    return card;
}

test("a card shows its line, runs it once and then updates it", async () => {
    const { app, requests, store } = pageWith(state("sphere crown", "pointset generate crown"));
    const card = growCard(app);
    card.set("step", ["0.3"], false);
    assert.equal(requests.at(-1), "preview grow tree crown step=0.3");
    assert.ok(await card.run());
    assert.equal(requests.at(-1), "run grow tree crown step=0.3\nradii tree");
    assert.equal(card.bound.peek()?.statement, 2);
    card.set("step", ["0.4"], false);
    assert.match(requests.at(-1) ?? "", /^preview/);
    card.set("step", ["0.4"], true);
    await new Promise((resolve) => setTimeout(resolve));
    assert.ok(requests.includes("text sphere crown; pointset generate crown; grow tree crown step=0.4; radii tree"));
    assert.equal(store.state.peek().statements.length, 4); // no further statements
    card.set("step", ["0.1"], true); // its default requires no word
    await new Promise((resolve) => setTimeout(resolve));
    assert.equal(store.state.peek().statements[2].text, "grow tree crown");
});

test("statements that change an object are placed before those that use it", async () => {
    const { app, requests } = pageWith(state("sphere crown", "pointset generate crown", "grow tree crown"));
    const card = new Card(app, { commands: ["pointset thin"], suggest: () => ({ points: ["crown"], percent: ["50"] }), shows: true });
    card.renew();
    card.set("percent", ["60"], false);
    assert.equal(requests.at(-1), "preview pointset thin crown 60 about crown");
    await card.run();
    assert.equal(requests.at(-1), "run pointset thin crown 60 about crown");
});

test("changes of a bound statement are read again, and a removed statement is released", () => {
    const { app, store } = pageWith(state("sphere crown", "pointset generate crown", "grow tree crown step=0.2"));
    store.state.value = { ...store.state.peek(), objects: [{ ...tree, statement: 2 }] };
    const card = growCard(app);
    const creator = creatorOf(store.state.peek(), store.schema.peek(), store.state.peek().objects[0], ["grow"]);
    assert.ok(creator);
    card.bind(creator);
    store.state.value = {
        ...state("sphere crown", "# a comment", "pointset generate crown", "grow tree crown step=0.7"),
        objects: [{ ...tree, statement: 3 }],
    };
    card.follow(store.state.peek());
    assert.equal(card.bound.peek()?.statement, 3);
    assert.deepEqual(card.values.peek().step, ["0.7"]);
    store.state.value = state("sphere crown");
    card.follow(store.state.peek());
    assert.equal(card.bound.peek(), null);
});

test("stopped growth is shown, and kept by one option", async () => {
    let stop: (error: Error) => void = () => undefined;
    const { app, requests, store } = pageWith(state("sphere crown", "pointset generate crown"), (text) =>
        text.includes("max_iterations")
            ? Promise.resolve()
            : new Promise<void>((_, reject) => {
                  stop = reject;
              }),
    );
    const watch = new GrowthWatch(app);
    const card = growCard(app, watch);
    const done = card.run();
    await new Promise((resolve) => setTimeout(resolve));
    store.grown.value = { statement: 2, key: "k", nodes: 240, until: "max_iterations=31" };
    assert.deepEqual(watch.now.peek()?.nodes, 240);
    stop(new EngineError("stopped", "cancelled"));
    assert.equal(await done, false);
    assert.equal(watch.now.peek()?.phase, "stopped");
    assert.ok(store.keepsGrowthPreview.peek()); // it is still in the view
    watch.keep(card);
    await new Promise((resolve) => setTimeout(resolve));
    assert.ok(requests.includes("run grow tree crown step=0.2 max_iterations=31\nradii tree"));
    assert.equal(watch.now.peek(), null);
    assert.equal(store.keepsGrowthPreview.peek(), false);
});

test("a newer value stops the running growth, and comments are kept", async () => {
    const ends: ((error: Error) => void)[] = [];
    const { app, requests, store } = pageWith(state("pointset generate crown", "grow tree crown step=0.2 # slow"), (text) =>
        text.includes("step=0.5") ? Promise.resolve() : new Promise<void>((_, reject) => ends.push(reject)),
    );
    Object.assign(app.engine, { cancel: () => ends.forEach((end) => end(new EngineError("stopped", "cancelled"))) });
    const watch = new GrowthWatch(app);
    const card = growCard(app, watch);
    const creator = creatorOf(store.state.peek(), store.schema.peek(), { ...tree, statement: 1 }, ["grow"]);
    assert.ok(creator);
    card.bind(creator);
    card.set("step", ["0.3"], true);
    card.set("step", ["0.5"], true); // while the other grows
    await new Promise((resolve) => setImmediate(resolve));
    assert.equal(store.state.peek().statements[1].text, "grow tree crown step=0.5 # slow");
    assert.equal(watch.now.peek(), null); // the user does not have to decide about it
    card.set("step", ["0.5"], true);
    assert.equal(card.line, "grow tree crown step=0.5 # slow");
    assert.equal(requests.filter((one) => one.startsWith("text")).length, 2);
});

test("stopped growth can be discarded, and rejections are reported", async () => {
    const { app, requests, store } = pageWith(state("sphere crown"), (text) =>
        Promise.reject(text.includes("0.9") ? new EngineError("kill_radius has to be a step at least", "input") : new EngineError("stopped", "cancelled")),
    );
    const watch = new GrowthWatch(app);
    const card = growCard(app, watch);
    assert.equal(await card.run(), false);
    assert.equal(watch.now.peek(), null); // no result yet
    assert.match(store.messages.peek().at(-1)?.text ?? "", /before the tree had grown/);
    card.set("step", ["0.9"], false);
    await card.run();
    assert.equal(card.errorText.peek(), "kill_radius has to be a step at least");
    assert.equal(requests.at(-1), "end");
});

test("the newest preview of growth is requested, and a missing one is ignored", async () => {
    const requests: string[] = [];
    const engine = { blob: async (key: string) => Promise.reject(new Error(`${requests.push(key)} is gone`)) };
    const turns: (() => void)[] = [];
    const next = async () => {
        turns.shift()?.();
        await new Promise((done) => setImmediate(done));
    };
    const grown = new GrowthPreview(
        engine as unknown as App["engine"],
        () => assert.fail("no result is drawn"),
        () => new Promise((done) => turns.push(() => done(undefined))),
    );
    for (const key of ["a", "b", "c"]) {
        grown.show(key, kDark);
    }
    await next();
    assert.deepEqual(requests, ["c"]);
    grown.show("d", kDark);
    grown.clear();
    await next();
    assert.deepEqual(requests, ["c"], "growth ended before it was requested");
    grown.show("e", kDark);
    await next();
    assert.deepEqual(requests, ["c", "e"]);
});
