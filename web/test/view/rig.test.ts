// Camera: rotation, zoom and framing, and positions of points in the view.
import assert from "node:assert/strict";
import { test } from "node:test";
import * as THREE from "three";
import { between, Rig } from "../../src/view/camera/rig";
import { cutTriangles, SectionPlane } from "../../src/view/section";

function rig(): Rig {
    const rig = new Rig();
    rig.resize(800, 600);
    return rig;
}

/** The position of a point in the view, both coordinates in [-1, 1]. */
function seen(of: Rig, point: THREE.Vector3): THREE.Vector3 {
    of.apply(new THREE.Sphere(new THREE.Vector3(), 100));
    return point.clone().project(of.camera);
}

const near = (a: number, b: number, most = 1e-6): void => assert.ok(Math.abs(a - b) < most, `${a} is not ${b}`);

test("the center of a rotation or a zoom keeps its position in the view", () => {
    for (const isParallel of [false, true]) {
        const one = rig();
        one.isParallel = isParallel;
        const pivot = one.target().add(new THREE.Vector3(1, 0.5, -0.7));
        const before = seen(one, pivot);
        one.orbit(0.4, -0.2, pivot);
        const turned = seen(one, pivot);
        one.zoom(0.3, pivot);
        const neared = seen(one, pivot);
        for (const now of [turned, neared]) {
            near(now.x, before.x);
            near(now.y, before.y);
        }
    }
});

test("the camera does not rotate beyond the zenith", () => {
    const one = rig();
    one.orbit(0, 10, one.target());
    near(one.pose.pitch, Math.PI / 2);
    near(one.forward().z, -1);
});

test("panning moves points at the reference depth by the same number of pixels", () => {
    const one = rig();
    const point = one.target();
    one.pan(40, -30, one.depth(point));
    const now = seen(one, point);
    near(now.x * 400, 40, 1e-3);
    near(now.y * 300, 30, 1e-3);
});

test("a framed sphere fits exactly, from every direction and in narrow views", () => {
    const sphere = new THREE.Sphere(new THREE.Vector3(3, -2, 5), 2);
    for (const [width, height] of [
        [800, 600],
        [300, 900],
    ]) {
        const one = rig();
        one.resize(width, height);
        one.pose = one.framing(sphere, "top");
        assert.ok(one.sees(sphere));
        assert.ok(!one.sees(new THREE.Sphere(sphere.center, 2.2)));
        const middle = seen(one, sphere.center);
        near(middle.x, 0);
        near(middle.y, 0);
        // From the camera the sphere fills the shorter side: its outline is at sin(angle) = radius / distance.
        const distance = one.pose.eye.distanceTo(sphere.center);
        const half = Math.atan(Math.tan((20 * Math.PI) / 180) * Math.min(1, width / height));
        near(Math.sin(half), sphere.radius / distance);
    }
});

test("transitions between two views use the shorter rotation", () => {
    const one = rig();
    const from = { ...one.lookingFrom("front"), yaw: 3.1 };
    const to = { ...from, yaw: -3.1 };
    const half = between(from, to, 0.5);
    near(Math.abs(half.yaw), Math.PI, 0.01);
});

test("a plane through a cube has a square outline and hides one side", () => {
    const position = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1]);
    const quads = [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ];
    const index = quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
    const ends = cutTriangles(position, index, new THREE.Vector3(0, 0, 1), -0.25);
    let length = 0;
    for (let i = 0; i < ends.length; i += 6) {
        near(ends[i + 2], 0.25);
        length += Math.hypot(ends[i] - ends[i + 3], ends[i + 1] - ends[i + 4]);
    }
    near(length, 4);
    const plane = new SectionPlane();
    plane.place({ on: true, axis: "z", at: 0.25, flipped: false }, new THREE.Box3(new THREE.Vector3(), new THREE.Vector3(1, 1, 1)));
    assert.ok(plane.hides(new THREE.Vector3(0, 0, 0.3)));
    assert.ok(!plane.hides(new THREE.Vector3(0, 0, 0.2)));
    near(plane.middle.z, 0.25);
});
