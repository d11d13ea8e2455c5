// Handles on the screen for moving, rotating and scaling: arrows, squares, rings and boxes, with a constant size in pixels.
import * as THREE from "three";
import type { App } from "../../app";
import type { Point } from "../../protocol";
import type { Mode } from "./change";
import { circlePoints, Overlay, kColors } from "./overlay";
import type { Axis } from "./typed_input";
import { add, kAxes, scaled, subtract, toSegment } from "./vector";

const kReach = 90; // [px] of an arrow
export const kRing = 76; // [px]
const kSquare = 34; // [px] from the pivot to the centre of the square of a plane
const kNear = 12; // [px] tolerance for a finger or pointer
const kGuide = 1000; // [px] from the pivot to the ends of the line along an axis
const kAxisNames: readonly Axis[] = ["x", "y", "z"];

export interface Handle {
    axis: Axis | null; // null: in the plane of the view
    plane: boolean; // across the axis
}

export class Gizmo {
    private readonly overlay: Overlay;
    private shown = "";

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
    }

    stop(): void {
        this.overlay.stop();
    }

    hide(): void {
        this.shown = "";
        this.overlay.clear();
    }

    /** Draws the handles, and a line along the active axis; does nothing if they are already drawn there. */
    show(mode: Mode, pivot: Point, hot: Handle | null, evenly: boolean, guide: Axis | null): void {
        const size = this.app.view.pixelSize(pivot);
        const key = [mode, ...pivot, size.toPrecision(4), hot?.axis, hot?.plane, evenly, guide].join(" ");
        if (key === this.shown) {
            return;
        }
        this.overlay.clear();
        this.shown = key;
        if (guide) {
            const far = scaled(kAxes[guide], kGuide * size);
            this.overlay.line([subtract(pivot, far), add(pivot, far)], kColors[guide], false, 1);
        }
        const color = (axis: Axis, plane: boolean) => (hot?.axis === axis && hot.plane === plane ? kColors.hot : kColors[axis]);
        for (const axis of mode === "size" && evenly ? [] : kAxisNames) {
            if (mode === "turn") {
                this.overlay.circle(pivot, kAxes[axis], kRing * size, color(axis, false));
                continue;
            }
            const tip = add(pivot, scaled(kAxes[axis], kReach * size));
            this.overlay.line([pivot, tip], color(axis, false));
            this.solid(mode, tip, axis, size, color(axis, false));
            this.square(pivot, axis, size, color(axis, true));
        }
        const middle = hot && !hot.axis ? kColors.hot : kColors.plain;
        this.overlay.dots([pivot], middle, 11);
        if (mode === "size") {
            this.overlay.line(this.facing(pivot, kRing * size), middle);
        }
    }

    /** The handle at a position of the view. */
    at(mode: Mode, pivot: Point, x: number, y: number, evenly: boolean): Handle | null {
        const { view } = this.app;
        const size = view.pixelSize(pivot);
        const center = view.toPixels(pivot);
        const far = Math.hypot(x - center[0], y - center[1]);
        if (far < kNear || (mode === "size" && evenly && Math.abs(far - kRing) < kNear)) {
            return { axis: null, plane: false };
        }
        let best: { handle: Handle; far: number } | null = null;
        const offer = (off: number, axis: Axis, plane: boolean) => {
            if (off < kNear && off < (best?.far ?? Infinity)) {
                best = { handle: { axis, plane }, far: off };
            }
        };
        for (const axis of mode === "size" && evenly ? [] : kAxisNames) {
            if (mode === "turn") {
                const ring = circlePoints(pivot, kAxes[axis], kRing * size, 48).map((point) => view.toPixels(point));
                const off = ring.slice(1).map((point, i) => toSegment(x, y, ring[i], point).far);
                offer(Math.min(...off), axis, false);
                continue;
            }
            const square = view.toPixels(squareMiddle(pivot, axis, size));
            offer(Math.hypot(x - square[0], y - square[1]), axis, true);
            const tip = view.toPixels(add(pivot, scaled(kAxes[axis], kReach * size)));
            offer(toSegment(x, y, center, tip).far, axis, false);
        }
        return (best as { handle: Handle } | null)?.handle ?? null;
    }

    private facing(pivot: Point, radius: number): Point[] {
        const [x, y] = this.app.view.toPixels(pivot);
        return circlePoints(pivot, this.app.view.ray(x, y).direction, radius);
    }

    private solid(mode: Mode, tip: Point, axis: Axis, size: number, color: number): void {
        const shape = mode === "move" ? new THREE.ConeGeometry(6 * size, 18 * size, 12) : new THREE.BoxGeometry(11 * size, 11 * size, 11 * size);
        const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
        const mesh = new THREE.Mesh(shape, material);
        mesh.position.set(...tip);
        mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...kAxes[axis]));
        mesh.renderOrder = 11;
        this.overlay.group.add(mesh);
    }

    private square(pivot: Point, axis: Axis, size: number, color: number): void {
        const [u, v] = otherAxes(axis).map((name) => scaled(kAxes[name], 8 * size));
        const middle = squareMiddle(pivot, axis, size);
        const corner = (a: number, b: number) => add(middle, add(scaled(u, a), scaled(v, b)));
        const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        this.overlay.area(corners, color);
        this.overlay.line([...corners, corners[0]], color);
    }
}

function otherAxes(axis: Axis): Axis[] {
    return kAxisNames.filter((name) => name !== axis);
}

function squareMiddle(pivot: Point, axis: Axis, size: number): Point {
    const [u, v] = otherAxes(axis).map((name) => scaled(kAxes[name], kSquare * size));
    return add(pivot, add(u, v));
}
