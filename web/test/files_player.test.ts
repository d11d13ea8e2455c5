// Fetching and playing of a film, with a fake engine.
import assert from "node:assert/strict";
import { test } from "node:test";
import { signal } from "@preact/signals-core";
import * as THREE from "three";
import type { App, Geometry } from "../src/app";
import { Player } from "../src/panels/files/animation/player";
import { type Film, kFirstFilm } from "../src/panels/files/animation/timeline";
import { eyeOf, sunOptions } from "../src/panels/files/camera";
import { formatsOf, isWritten } from "../src/panels/files/formats";
import { createStore } from "../src/store";

const kFilm: Film = { ...kFirstFilm, tree: "oak", duration: 0.5, rate: 10 }; // five frames of wind

interface Trial {
    player: Player;
    film: ReturnType<typeof signal<Film>>;
    requests: number[]; // times of `frame`
    drawn: Geometry[];
    settled: () => number;
    store: ReturnType<typeof createStore>;
    fail(message: string): void;
}

// An engine that returns a number of frames, and can delay one.
function trial(most = Infinity): Trial {
    const store = createStore();
    const requests: number[] = [];
    const drawn: Geometry[] = [];
    let settled = 0;
    let failure = "";
    const surface = (time: number): Geometry => ({
        header: { kind: "surface", object: { kind: "skeleton", name: "oak" }, version: 7, origin: [0, 0, 0], arrays: [] },
        arrays: {
            position: Float32Array.of(time, 0, 0, 1, 1, 1),
            normal: new Int8Array(8),
            quads: Uint32Array.of(0, 1, 0, 1),
            uv: Float32Array.of(0, 0, 1, 1),
        },
    });
    const app = {
        store,
        engine: {
            request: async (_: string, { time }: { time: number }) => {
                requests.push(Number(time.toFixed(3)));
                if (failure) {
                    throw new Error(failure);
                }
                return { key: String(time), images: [{ color: "c" }] };
            },
            blob: async (key: string) => {
                return --most < 0 ? new Promise<Geometry>(() => {}) : surface(Number(key));
            },
        },
        view: {
            receive: (geometry: Geometry) => drawn.push(geometry),
            settle: () => ++settled,
            geometry: () => drawn.at(-1),
        },
    } as unknown as App;
    const film = signal(kFilm);
    const fail = (message: string) => {
        failure = message;
    };
    return { player: new Player(app, film), film, requests, drawn, settled: () => settled, store, fail };
}

// Until all automatic requests have finished.
const idle = () => new Promise((done) => setImmediate(done));

// The clock, which a test sets.
let clock = 0; // [ms]
performance.now = () => clock;

// Animation frames of the browser, triggered by hand.
function playing(): { next(): void } {
    const waiting: (() => void)[] = [];
    globalThis.requestAnimationFrame = (then) => waiting.push(() => then(clock));
    return { next: () => waiting.splice(0).forEach((then) => then()) };
}

test("the first frame is drawn completely, later frames as patches of it", async () => {
    const { player, requests, drawn } = trial();
    player.seek(0.1);
    await idle();
    player.seek(0.2);
    await idle();
    player.seek(0.1); // is already available
    await idle();
    assert.deepEqual(requests, [0.1, 0.2]);
    assert.deepEqual(
        drawn.map(({ header }) => header.kind),
        ["surface", "patch", "patch"],
    );
    assert.equal(drawn[1].header.base, drawn[0].header.version);
    assert.equal(drawn[2].header.base, drawn[1].header.version);
    assert.deepEqual(drawn[1].header.ranges, { vertices: [[0, 2]], quads: [] });
    assert.equal(drawn[2].arrays.position[0], Math.fround(0.1));
});

test("every frame of a growing tree is drawn completely", async () => {
    const { player, film, drawn } = trial();
    film.value = { ...kFilm, grow: true };
    for (const time of [0.1, 0.2]) {
        player.seek(time);
        await idle();
    }
    assert.deepEqual(
        drawn.map(({ header }) => header.kind),
        ["surface", "surface"],
    );
});

test("a playing film requests each following frame once", async () => {
    const { next } = playing();
    const { player, requests } = trial();
    player.seek(0.3);
    await idle();
    assert.deepEqual(requests, [0.3]);
    player.play();
    next();
    await idle();
    player.pause();
    next();
    await idle();
    assert.deepEqual([...requests].sort(), [0, 0.1, 0.2, 0.3, 0.4]);
    assert.deepEqual(requests.slice(0, 3), [0.3, 0.4, 0]); // the following frames, with wrap-around
    assert.equal(player.fetched.peek(), 5);
});

test("a playing film shows the newest available frame", async () => {
    const { next } = playing();
    const { player, film, drawn } = trial(2);
    film.value = { ...kFilm, duration: 9 };
    player.play();
    await idle();
    next(); // frame 0 and the next one are available
    await idle();
    clock += 550;
    next(); // frame 5 would be shown
    assert.equal(drawn.at(-1)?.arrays.position[0], Math.fround(0.1));
    player.close();
});

test("only a different film is requested again; a changed tree is shown at rest", async () => {
    const { player, film, requests, store, settled } = trial();
    player.seek(0.2);
    await idle();
    film.value = { ...kFilm };
    await idle();
    assert.equal(requests.length, 1);
    film.value = { ...kFilm, wind: { ...kFilm.wind, speed: 20 } };
    await idle();
    assert.equal(requests.length, 2);
    const oak = {
        kind: "skeleton" as const,
        name: "oak",
        version: 2,
        statement: 0,
        bounds: [0, 0, 0, 1, 1, 1] as [number, number, number, number, number, number],
        count: 2,
        unit: "nodes",
    };
    store.state.value = { ...store.state.peek(), objects: [oak] };
    await idle();
    assert.deepEqual([requests.length, player.open.peek(), settled()], [2, false, 1]);
    player.seek(0.2);
    await idle();
    assert.equal(requests.length, 3);
});

test("an error of the engine is reported, and the tree is shown at rest again", async () => {
    const { player, film, fail, settled } = trial();
    fail("key:2: there is no node 99");
    player.seek(0.2);
    await idle();
    assert.equal(player.errorText.peek(), "key:2: there is no node 99");
    assert.equal(player.open.peek(), false);
    assert.equal(settled(), 1);
    fail("");
    film.value = { ...kFilm, rate: 12 };
    assert.equal(player.errorText.peek(), "");
});

test("a picture uses the camera position of the view", () => {
    const camera = new THREE.PerspectiveCamera(40, 1.5);
    camera.up.set(0, 0, 1);
    camera.position.set(3, -4, 2);
    camera.lookAt(3, 0, 2); // along +Y, with Z up
    camera.updateMatrixWorld();
    const { eye, target, up, field_of_view } = eyeOf(camera);
    const rounded = (point: number[]) => point.map((value) => Math.round(value * 1e6) / 1e6 + 0);
    assert.deepEqual([rounded(eye), rounded(target), rounded(up), field_of_view], [[3, -4, 2], [3, -3, 2], [0, 0, 1], 40]);
    const flat = new THREE.OrthographicCamera(-3, 3, 2, -2);
    assert.equal(eyeOf(flat).parallel, 4);
    const { azimuth, sun_azimuth, sun_elevation } = sunOptions(12, 0); // noon: in the south, at 60 degrees
    assert.deepEqual([azimuth, sun_azimuth, Math.round(sun_elevation)], [0, -90, 60]);
});

test("only formats that support all chosen contents are offered", () => {
    const endings = (...kinds: Parameters<typeof formatsOf>[0]) => formatsOf(kinds).map(({ id }) => id);
    assert.deepEqual(endings("solid"), endings("skeleton", "mesh"));
    assert.ok(endings("skeleton").includes("skeleton.ply") && endings("skeleton").includes("surface.ply"));
    assert.deepEqual(endings("points"), ["points.xyz", "points.ply"]);
    assert.deepEqual(endings("points", "mesh"), []);
    assert.ok(!isWritten("path") && isWritten("solid"));
});

test("frames show the bark of the surface of the tree, and hold its coordinates once", async () => {
    const { player, drawn } = trial();
    player.seek(0);
    await idle();
    player.seek(0.1);
    await idle();
    assert.deepEqual(drawn[0].header.images, [{ color: "c" }]);
    assert.deepEqual([...drawn[0].arrays.uv], [0, 0, 1, 1]);
    assert.equal(drawn[1].header.kind, "patch");
    assert.equal(drawn[1].arrays.uv, undefined);
});
