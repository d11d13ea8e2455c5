// Keys and frames of animations.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
    type Film,
    frameAt,
    frameCount,
    freeTime,
    kFirstFilm,
    keysText,
    lastEdit,
    motionFields,
    moves,
    readKeys,
    timeOf,
    withKey,
    withoutKey,
} from "../src/panels/files/animation/timeline";

const kCalm = { ...kFirstFilm.wind, speed: 0 };
const keyed: Film = {
    ...kFirstFilm,
    tree: "oak",
    wind: kCalm,
    duration: 1.5,
    rate: 12,
    keys: readKeys("0: rest\n\n# up and back\n1.5 out: rotate near(2,0,3) 20 about=side # so far\n.25 : bend 19 20; twist roots 40\n"),
};

test("keys are parsed and formatted as in files", () => {
    assert.deepEqual(
        keyed.keys.map(({ time, easing }) => [time, easing]),
        [
            [0, "smooth"],
            [0.25, "smooth"],
            [1.5, "out"],
        ],
    );
    assert.equal(keysText(keyed.keys), "0: rest\n0.25: bend 19 20; twist roots 40\n1.5 out: rotate near(2,0,3) 20 about=side\n");
    assert.deepEqual(readKeys(keysText(keyed.keys)), keyed.keys);
    assert.deepEqual(readKeys("2:"), [{ time: 2, easing: "smooth", edits: "rest" }]);
    assert.throws(() => readKeys("0: rest\nsoon: rest"), /Line 2/);
    assert.throws(() => readKeys("1 bouncing: rest"), /not a key/);
});

test("keys have one frame more than the periodic wind", () => {
    assert.equal(frameCount(keyed), 19); // 1.5 s at 12, and the last frame
    assert.equal(frameCount({ ...keyed, wind: kFirstFilm.wind }), 18);
    assert.equal(frameCount({ ...keyed, grow: true, duration: 2 }), 24);
    assert.equal(frameAt(keyed, 99), 18);
    assert.equal(frameAt(keyed, -1), 0);
    assert.equal(frameAt(keyed, 0.5), 6);
    assert.equal(timeOf(keyed, 6), 0.5);
    assert.ok(!moves({ ...keyed, keys: [] }) && moves(keyed) && moves(kFirstFilm));
});

test("keys are on frames, at most one per frame", () => {
    assert.equal(freeTime(keyed, 0.26), 0.333); // 3 of 12 is occupied, 4 is next
    assert.equal(freeTime(keyed, 0.26, keyed.keys[1]), 0.25);
    assert.equal(freeTime(keyed, -3), 0.083);
    assert.equal(freeTime(keyed, 9), 1.417); // the last frame, 18, is occupied
    const key = { time: 1, easing: "in" as const, edits: "rest" };
    const more = withKey(keyed, key);
    assert.deepEqual(
        more.keys.map(({ time }) => time),
        [0, 0.25, 1, 1.5],
    );
    const moved = withKey(more, { ...key, time: 2 }, key);
    assert.deepEqual(
        moved.keys.map(({ time }) => time),
        [0, 0.25, 1.5, 2],
    );
    assert.deepEqual(withoutKey(more, key).keys, keyed.keys);
});

test("requests contain only the chosen motion", () => {
    assert.deepEqual(motionFields(keyed), { name: "oak", keys: keysText(keyed.keys), options: { duration: 1.5, rate: 12 } });
    const grown = motionFields({ ...keyed, grow: true });
    assert.deepEqual(grown, { name: "oak", keys: "", options: { duration: 1.5, rate: 12, grow: true, grow_age: "length", grow_exponent: 2.5 } });
    assert.equal(motionFields({ ...keyed, wind: { ...kCalm, speed: 5 } }).options.wind_speed, 5);
});

test("the last edit of a skeleton becomes a key if it only moves nodes", () => {
    const all = (...texts: string[]) => texts.map((text, line) => ({ text, line: line + 1, message: "" }));
    const bend = "edit bend oak subtree(12) 20 about=side  # lift";
    assert.deepEqual(lastEdit(all("loadtree oak oak.swc", bend, "edit bend elm 3 4"), "oak"), { statement: 1, edits: "bend subtree(12) 20 about=side" });
    assert.deepEqual(lastEdit(all("edit rotate tree=oak 12 20"), "oak"), { statement: 0, edits: "rotate 12 20" });
    assert.equal(lastEdit(all(bend, "edit prune oak radius=0.01"), "oak"), null);
    assert.equal(lastEdit(all("repeat 2\nedit bend oak 1 2\nend"), "oak"), null);
});
