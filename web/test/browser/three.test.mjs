// GLB files with materials of bark, twigs and cuts, as three.js reads them.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { PNG } from "pngjs";
import { endBrowser, startBrowser } from "./browser.mjs";

const kRoot = fileURLToPath(new URL("../../../", import.meta.url));
const kThree = join(kRoot, "web/node_modules/three");
const kPage = `<!doctype html><script type="importmap">{"imports": {"three": "/build/three.module.js", "three/addons/": "/examples/jsm/"}}</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
globalThis.loaded = new GLTFLoader().loadAsync("/tree.glb").then(({ scene }) => ({ THREE, scene }));
</script>`;

let folder;
let server;
let page;

before(async () => {
    const browser = await startBrowser();
    folder = await mkdtemp(join(tmpdir(), "coppice three "));
    const coppice = (...args) => promisify(execFile)(process.env.COPPICE, args, { cwd: folder });
    await coppice("texture", "bark", "oak", "-o", "bark", "--width", "64");
    await coppice("texture", "bark", "birch", "-o", "twig", "--width", "32");
    await coppice("texture", "cut", "oak", "-o", "cut", "--cut-size", "48");
    const materials = ["--material", "bark", "--twig-material", "twig", "--twig-diameter", "0.1", "--cut-material", "cut"];
    await coppice("mesh", join(kRoot, "examples/oak.swc"), "-o", "tree.glb", "--uv", "bark", "--base", "flat", ...materials);
    server = createServer((request, response) => answer(request, response));
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction(() => globalThis.loaded);
});

after(async () => {
    await endBrowser();
    server?.close();
    await rm(folder, { recursive: true, force: true });
});

async function answer(request, response) {
    const isScript = request.url.endsWith(".js");
    response.setHeader("Content-Type", isScript ? "text/javascript" : "text/html");
    if (request.url === "/") {
        response.end(kPage);
    } else if (isScript) {
        response.end(await readFile(join(kThree, request.url)));
    } else if (request.url === "/tree.glb") {
        response.end(await readFile(join(folder, "tree.glb")));
    } else {
        response.writeHead(404).end();
    }
}

/** The mean colour of a PNG, from 0 to 255. */
async function meanColor(name) {
    const { data } = PNG.sync.read(await readFile(join(folder, name)));
    const sum = [0, 0, 0];
    for (let i = 0; i < data.length; ++i) {
        if (i % 4 < 3) {
            sum[i % 4] += data[i];
        }
    }
    return sum.map((value) => (4 * value) / data.length);
}

test("every slot has its images", async () => {
    const found = await page.evaluate(async () => {
        const { THREE, scene } = await globalThis.loaded;
        const out = {};
        scene.traverse((mesh) => {
            if (!mesh.isMesh) {
                return;
            }
            const { map, normalMap, roughnessMap, aoMap, name } = mesh.material;
            const canvas = new OffscreenCanvas(map.image.width, map.image.height);
            const context = canvas.getContext("2d");
            context.drawImage(map.image, 0, 0);
            const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
            const mean = [0, 1, 2].map((k) => data.reduce((sum, value, i) => sum + (i % 4 === k ? value : 0), 0) / (data.length / 4));
            out[name] = {
                width: map.image.width,
                mean,
                repeats: map.wrapS === THREE.RepeatWrapping && map.wrapT === THREE.RepeatWrapping,
                isColor: map.colorSpace === THREE.SRGBColorSpace,
                hasOthers: Boolean(normalMap && roughnessMap && aoMap),
                hasTangents: Boolean(mesh.geometry.attributes.tangent),
            };
        });
        return out;
    });
    assert.deepEqual(Object.keys(found).sort(), ["bark", "cut", "twig"]);
    for (const [name, width] of [
        ["bark", 64],
        ["twig", 32],
        ["cut", 48],
    ]) {
        const { mean, ...slot } = found[name];
        assert.deepEqual(slot, { width, repeats: true, isColor: true, hasOthers: true, hasTangents: true }, name);
        const expected = await meanColor(`${name}_color.png`);
        for (const k of [0, 1, 2]) {
            assert.ok(Math.abs(mean[k] - expected[k]) < 1, `${name}: ${mean} instead of ${expected}`);
        }
    }
});

test("faces have the material of their place", async () => {
    const found = await page.evaluate(async () => {
        const { THREE, scene } = await globalThis.loaded;
        scene.updateMatrixWorld(true);
        const hit = (from, direction) => {
            const [first] = new THREE.Raycaster(new THREE.Vector3(...from), new THREE.Vector3(...direction)).intersectObject(scene, true);
            return { name: first?.object.material.name, u: first?.uv.x, v: first?.uv.y };
        };
        // glTF has y up; the stem has its base at the origin.
        return { below: hit([0, -5, 0], [0, 1, 0]), low: hit([5, 0.6, 0], [-1, 0, 0]), high: hit([5, 1.2, 0], [-1, 0, 0]) };
    });
    assert.equal(found.below.name, "cut");
    assert.ok(Math.hypot(found.below.u - 0.5, found.below.v - 0.5) < 0.3, "the pith is in the middle of the picture");
    assert.equal(found.low.name, "bark");
    assert.equal(found.high.name, "bark");
    // Images have their first row at the top: v decreases upwards in glTF.
    assert.ok(found.high.v < found.low.v);
});

test("it is drawn without errors", async () => {
    const complaints = [];
    page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
    const picture = await page.evaluate(async () => {
        const { THREE, scene } = await globalThis.loaded;
        const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
        renderer.setSize(200, 200);
        renderer.setClearColor(0x0000ff);
        const world = new THREE.Scene();
        world.add(scene, new THREE.HemisphereLight(0xffffff, 0x888888, 3));
        const camera = new THREE.PerspectiveCamera(30, 1, 0.1, 100);
        camera.position.set(0, 4, 16);
        camera.lookAt(0, 3.5, 0);
        renderer.render(world, camera);
        return renderer.domElement.toDataURL("image/png");
    });
    const { data } = PNG.sync.read(Buffer.from(picture.split(",")[1], "base64"));
    let wood = 0;
    for (let i = 0; i < data.length; i += 4) {
        wood += data[i] > data[i + 2] - 60 && data[i + 2] < 200 ? 1 : 0;
    }
    assert.ok(wood > 1000, `${wood} pixels of wood`);
    assert.deepEqual(complaints, []);
});
