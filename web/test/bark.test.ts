// The bark of a surface as a change of the text, and the images of materials.
import assert from "node:assert/strict";
import { test } from "node:test";
import * as THREE from "three";
import type { App, Engine } from "../src/app";
import { creatorOf } from "../src/panels/grow/card";
import { withBark } from "../src/panels/grow/bark";
import type { State } from "../src/protocol";
import { createStore } from "../src/store";
import { Materials, setMaps } from "../src/view/materials";
import { barkOf } from "../src/view/sources";
import { schema, stateOf } from "./scene/schema";

/** The text after the selection of a bark for the mesh of the last statement. */
function changed(text: string, species: string): string {
    const mesh = text.trimEnd().split("\n").length - 1;
    const state: State = stateOf(text, [["mesh:t", mesh]]);
    const surface = creatorOf(state, schema, state.objects[0], ["mesh"]);
    assert.ok(surface);
    return withBark(state, schema, surface, species, "bark");
}

const kPlain = "grow t points\n\nmesh t levels=1 # a tree\n";
const kBarked = "grow t points\n\nmaterial bark oak\nmesh t levels=1 uv=bark material=bark # a tree\n";

test("a bark is a material before the surface and its options", () => {
    assert.equal(changed(kPlain, "oak"), kBarked);
});

test("another bark changes the material of the surface", () => {
    assert.equal(changed(kBarked, "pine"), kBarked.replace("oak", "pine"));
    const options = kBarked.replace("oak", "oak width=64 # coarse");
    assert.equal(changed(options, "pine"), options.replace("oak", "pine"));
});

test("no bark removes the material that only the surface uses", () => {
    assert.equal(changed(kBarked, ""), kPlain);
    const displaced = kBarked.replace("material=bark #", "material=bark displace=true #");
    assert.equal(changed(displaced, ""), kPlain);
});

test("the materials of other surfaces and images in files remain", () => {
    const shared = "grow t points\nmaterial wood oak\nmesh t other uv=bark material=wood\nmesh t uv=bark material=wood\n";
    assert.equal(changed(shared, ""), "grow t points\nmaterial wood oak\nmesh t other uv=bark material=wood\nmesh t\n");
    assert.equal(
        changed(shared, "pine"),
        "grow t points\nmaterial wood oak\nmesh t other uv=bark material=wood\nmaterial bark pine\nmesh t uv=bark material=bark\n",
    );
    const files = "grow t points\nloadmaterial wood oak_color.png\nmesh t uv=bark material=wood\n";
    assert.equal(changed(files, ""), "grow t points\nloadmaterial wood oak_color.png\nmesh t\n");
});

test("a film has the material of the mesh of its tree", () => {
    const store = createStore();
    store.schema.value = schema;
    store.state.value = stateOf(kBarked, [
        ["skeleton:t", 0],
        ["material:bark", 2],
        ["mesh:t", 3],
    ]);
    assert.equal(barkOf(store, "t"), "bark");
    assert.equal(barkOf(store, "other"), undefined);
});

/** An engine with images for each mesh, which counts their requests, and a browser that decodes and closes them. */
function imageEngine(images: Record<string, Record<string, string>[]>): { engine: Engine; log: string[] } {
    const log: string[] = [];
    Object.assign(globalThis, {
        createImageBitmap: async (blob: Blob, options: ImageBitmapOptions) => {
            assert.equal(options.imageOrientation, "flipY");
            const key = await blob.text();
            if (key === "broken") {
                throw new Error("not an image");
            }
            return { key, close: () => log.push(`close ${key}`) };
        },
    });
    const engine = {
        request: (_: string, { name }: { name: string }) => Promise.resolve({ images: images[name] }),
        image: (key: string) => {
            log.push(key);
            return Promise.resolve(new Blob([key]));
        },
    } as unknown as App["engine"];
    return { engine, log };
}

test("images are shared by meshes, repeat, and are released by the last one", async () => {
    const { engine, log } = imageEngine({ a: [{ color: "c", normal: "n" }], b: [{ color: "c" }] });
    const materials = new Materials(engine);
    const [a, b] = await Promise.all([materials.take("a"), materials.take("b")]);
    assert.deepEqual(log, ["c", "n"]);
    assert.equal(a.maps[0].map, b.maps[0].map);
    assert.equal(a.maps[0].map?.colorSpace, THREE.SRGBColorSpace);
    assert.equal(a.maps[0].normalMap?.colorSpace, THREE.NoColorSpace);
    assert.equal(a.maps[0].map?.wrapS, THREE.RepeatWrapping);
    assert.equal(a.maps[0].map?.flipY, false);
    a.release();
    await materials.take("b");
    assert.deepEqual(log, ["c", "n", "close n"]);
    b.release();
    assert.equal(materials.busy, false);
});

test("each slot has its images, and equal ones are requested once", async () => {
    const { engine, log } = imageEngine({ a: [{ color: "c" }, {}, { color: "c", normal: "n" }] });
    const materials = new Materials(engine);
    const { maps, release } = await materials.take("a");
    assert.deepEqual(log, ["c", "n"]);
    assert.equal(maps.length, 3);
    assert.equal(maps[0].map, maps[2].map);
    assert.deepEqual(maps[1], {});
    release();
    await new Promise((done) => setImmediate(done));
    assert.deepEqual(log, ["c", "n", "close c", "close n"]);
    await materials.takeImages([{ color: "n" }]); // of a frame of a film
    assert.deepEqual(log.slice(4), ["n"]);
});

test("an image that is not decoded is a fault, and is requested again", async () => {
    const { engine, log } = imageEngine({ a: [{ color: "broken", normal: "n" }] });
    const materials = new Materials(engine);
    await assert.rejects(materials.take("a"), /not an image/);
    await assert.rejects(materials.take("a"));
    assert.deepEqual(
        log.filter((key) => key === "broken"),
        ["broken", "broken"],
    );
});

test("a shader takes the images, and loses them with its material", () => {
    const material = new THREE.MeshStandardMaterial({ roughness: 0.5 });
    const texture = new THREE.Texture();
    setMaps(material, { map: texture, roughnessMap: texture });
    assert.equal(material.map, texture);
    assert.equal(material.roughness, 1); // the image contains the roughness
    const { version } = material;
    setMaps(material, { map: texture, roughnessMap: texture });
    assert.equal(material.version, version); // not compiled again
    setMaps(material, {});
    assert.equal(material.map, null);
    assert.ok(material.version > version);
});
