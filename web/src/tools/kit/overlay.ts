// Lines, dots and handles that tools draw into the view, with a constant size on the screen.
import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { App } from "../../app";
import type { Point } from "../../protocol";
import { discs } from "../../view/marks";

export const kColors = { x: 0xe5534b, y: 0x57ab5a, z: 0x539bf5, hot: 0xffd33d, plain: 0xf0f6fc, cut: 0xff5c5c, grow: 0x7ee787 };

const kRim = 0x15181a;

/** A group in the overlay that is emptied, and its GPU resources released, when its tool is deactivated. */
export class Overlay {
    readonly group = new THREE.Group();

    constructor(private readonly app: App) {
        this.group.renderOrder = 10;
        app.view.overlay.add(this.group);
    }

    clear(): void {
        for (const child of [...this.group.children]) {
            this.group.remove(child);
            const shape = child as THREE.Mesh;
            shape.geometry?.dispose();
            ([] as THREE.Material[]).concat(shape.material ?? []).forEach((material) => material.dispose());
        }
        this.app.view.requestDraw();
    }

    stop(): void {
        this.clear();
        this.app.view.overlay.remove(this.group);
        this.app.view.requestDraw();
    }

    /** A line through points; separate pairs if `pieces`. A dark rim makes it visible on any background. */
    line(points: readonly Point[], color = kColors.hot, pieces = false, wide = 2): void {
        const ends = pieces ? points : points.slice(1).flatMap((point, i) => [points[i], point]);
        if (ends.length === 0) {
            return;
        }
        for (const [shade, width, opacity] of [
            [kRim, 2 * wide, 0.45],
            [color, wide, 1],
        ]) {
            const geometry = new LineSegmentsGeometry().setPositions(new Float32Array(ends.flat()));
            const material = new LineMaterial({ color: shade, linewidth: width, opacity, depthTest: false, transparent: true, toneMapped: false });
            this.put(new LineSegments2(geometry, material));
        }
    }

    dots(points: readonly Point[], color = kColors.hot, size = 9): void {
        for (const [shade, across] of [
            [kRim, size + 3],
            [color, size],
        ]) {
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points.flat()), 3));
            this.put(new THREE.Points(geometry, discs(shade, across, true)));
        }
    }

    /** A transparent convex face between corners. */
    area(corners: readonly Point[], color = kColors.hot): void {
        const fan = corners.slice(2).flatMap((corner, i) => [corners[0], corners[i + 1], corner]);
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(fan.flat()), 3));
        const look = { color, transparent: true, opacity: 0.35, depthWrite: false, depthTest: false, side: THREE.DoubleSide };
        this.put(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(look)));
    }

    /** A circle about an axis. */
    circle(center: Point, axis: Point, radius: number, color = kColors.hot): void {
        this.line(circlePoints(center, axis, radius), color);
    }

    /** A transparent ball with its outline. */
    ball(center: Point, radius: number, color = kColors.hot): void {
        const material = new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.14, depthWrite: false, depthTest: false });
        const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 32, 16), material);
        mesh.position.set(...center);
        this.put(mesh);
        this.circle(center, sight(this.app, center), radius, color);
    }

    private put(mesh: THREE.Object3D): void {
        mesh.frustumCulled = false;
        mesh.renderOrder = 10;
        this.group.add(mesh);
        this.app.view.requestDraw();
    }
}

export function circlePoints(center: Point, axis: Point, radius: number, parts = 64): Point[] {
    const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...axis).normalize());
    return Array.from({ length: parts + 1 }, (_, i) => {
        const angle = (2 * Math.PI * i) / parts;
        const at = new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0).applyQuaternion(turn);
        return [center[0] + at.x, center[1] + at.y, center[2] + at.z] as Point;
    });
}

/** The direction from the camera into the view at a point. */
export function sight(app: App, point: Point): Point {
    const [x, y] = app.view.toPixels(point);
    return app.view.ray(x, y).direction;
}
