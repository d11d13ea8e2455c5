// Mouse and touch in the view, with synthetic events.
import assert from "node:assert/strict";
import { test } from "node:test";
import * as THREE from "three";
import type { ToolPointer } from "../../src/app";
import type { ActiveTool } from "../../src/active_tool";
import { Navigation } from "../../src/view/camera/navigate";
import { dragMotion, type Preset, wheelMotion } from "../../src/view/camera/presets";
import { Rig } from "../../src/view/camera/rig";

class FakePointer extends Event {}
(globalThis as { PointerEvent?: unknown }).PointerEvent = FakePointer;

function table(preset: Preset = "blender", handles = false) {
    const rig = new Rig();
    rig.resize(800, 600);
    const received: ToolPointer[] = [];
    const hovered: [number, number][] = [];
    const canvas = Object.assign(new EventTarget(), { focus() {}, setPointerCapture() {}, clientWidth: 800, clientHeight: 600 });
    const hand = { pointer: (event: ToolPointer) => (received.push(event), handles), wheel: () => false };
    const navigation = new Navigation(
        {
            rig,
            canvas: canvas as unknown as HTMLCanvasElement,
            preset: () => preset,
            pointUnder: () => new THREE.Vector3(0, 0, 1),
            hovered: (x, y) => void hovered.push([x, y]),
            own: () => false,
            moved() {},
            centre() {},
        },
        () => hand as unknown as ActiveTool,
    );
    const send = (type: string, x: number, y: number, more: Record<string, unknown> = {}) => {
        const fields = {
            offsetX: x,
            offsetY: y,
            pointerId: 1,
            pointerType: "mouse",
            button: 0,
            buttons: 1,
            pressure: 0,
            shiftKey: false,
            ctrlKey: false,
            ...more,
        };
        canvas.dispatchEvent(Object.assign(new FakePointer(`pointer${type}`), fields));
    };
    const finger = (type: string, x: number, y: number, pointerId = 1) => send(type, x, y, { pointerType: "touch", pointerId });
    return { rig, received, hovered, navigation, send, finger, phases: () => received.map(({ phase }) => phase) };
}

test("a drag that no tool accepts rotates the view, and the tool is cancelled", () => {
    const { rig, send, phases } = table();
    const before = rig.pose.yaw;
    send("down", 100, 100);
    send("move", 130, 100);
    send("move", 160, 100);
    send("up", 160, 100);
    assert.deepEqual(phases(), ["down", "cancel"]);
    assert.ok(Math.abs(rig.pose.yaw - before) > 0.2);
});

test("a drag that the tool accepts does not move the view", () => {
    const { rig, send, phases } = table("blender", true);
    const before = { ...rig.pose };
    send("down", 100, 100);
    send("move", 160, 100);
    send("up", 160, 100);
    assert.deepEqual(phases(), ["down", "move", "up"]);
    assert.equal(rig.pose.yaw, before.yaw);
});

test("a trembling finger taps at its first position", () => {
    const { received, finger, phases } = table();
    finger("down", 100, 100);
    finger("move", 106, 103);
    finger("up", 106, 103);
    assert.deepEqual(phases(), ["down", "up"]);
    assert.deepEqual([received[1].x, received[1].y], [100, 100]);
});

test("a resting finger shows the object and does not tap", async () => {
    const { hovered, rig, finger, phases } = table();
    const before = rig.pose.yaw;
    finger("down", 100, 100);
    await new Promise((done) => setTimeout(done, 520));
    assert.deepEqual(hovered, [[100, 100]]);
    finger("move", 180, 100);
    finger("up", 180, 100);
    assert.deepEqual(hovered.at(-1), [180, 100]);
    assert.deepEqual(phases(), ["down", "cancel"]);
    assert.equal(rig.pose.yaw, before);
});

test("two fingers zoom by their distance and pan by their center", () => {
    const { rig, finger, navigation } = table();
    const before = rig.pose.distance;
    finger("down", 300, 300, 1);
    finger("down", 400, 300, 2);
    assert.ok(navigation.isMoving);
    finger("move", 250, 300, 1);
    finger("move", 450, 300, 2);
    assert.ok(Math.abs(rig.pose.distance / before - 0.5) < 1e-9); // twice the separation: half the distance
    const eye = rig.pose.eye.clone();
    finger("move", 250, 340, 1);
    finger("move", 450, 340, 2);
    assert.ok(rig.pose.eye.distanceTo(eye) > 0.1);
    finger("up", 250, 340, 1);
    finger("up", 450, 340, 2);
    assert.ok(!navigation.isMoving);
});

test("buttons act according to their preset", () => {
    const none = { shift: false, control: false, alt: false };
    assert.equal(dragMotion("blender", 0, none), null); // for the tool
    assert.equal(dragMotion("blender", 0, { ...none, alt: true }), "orbit");
    assert.equal(dragMotion("blender", 1, none), "orbit");
    assert.equal(dragMotion("blender", 1, { ...none, shift: true }), "pan");
    assert.equal(dragMotion("cad", 1, none), "pan");
    assert.equal(dragMotion("cad", 2, none), "orbit");
    assert.equal(wheelMotion("trackpad", none), "orbit");
    assert.equal(wheelMotion("trackpad", { ...none, control: true }), "zoom"); // pinching
    assert.equal(wheelMotion("cad", none), "zoom");
});
