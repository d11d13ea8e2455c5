// A section plane: clipping, its handle, and the outline of the cut.
import * as THREE from "three";
import type { Section } from "./display";
import type { Theme } from "./theme";

const kAxes = { x: new THREE.Vector3(1, 0, 0), y: new THREE.Vector3(0, 1, 0), z: new THREE.Vector3(0, 0, 1) };
const kReach = 14; // [px] of the handle around its centre
const kMargin = 0.04; // margin of the frame, relative to the size of the scene

/** Intersects triangles with a plane: end points of lines, in the frame of the vertices. */
export function cutTriangles(position: Float32Array, index: ArrayLike<number>, normal: THREE.Vector3, constant: number): Float32Array {
    const ends: number[] = [];
    const height = (v: number) => position[3 * v] * normal.x + position[3 * v + 1] * normal.y + position[3 * v + 2] * normal.z + constant;
    for (let i = 0; i + 2 < index.length; i += 3) {
        const corners = [index[i], index[i + 1], index[i + 2]];
        const heights = corners.map(height);
        if (heights[0] > 0 === heights[1] > 0 && heights[1] > 0 === heights[2] > 0) {
            continue;
        }
        for (let k = 0; k < 3; ++k) {
            const [a, b] = [corners[k], corners[(k + 1) % 3]];
            const [ha, hb] = [heights[k], heights[(k + 1) % 3]];
            if (ha > 0 !== hb > 0) {
                const t = ha / (ha - hb);
                for (let c = 0; c < 3; ++c) {
                    ends.push(position[3 * a + c] + (position[3 * b + c] - position[3 * a + c]) * t);
                }
            }
        }
    }
    return Float32Array.from(ends);
}

export class SectionPlane {
    readonly group = new THREE.Group();
    readonly plane = new THREE.Plane();
    private readonly frame: THREE.LineLoop<THREE.BufferGeometry, THREE.LineBasicMaterial>;
    private readonly outline: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
    private readonly handle: THREE.Mesh<THREE.SphereGeometry, THREE.MeshBasicMaterial>;
    private section: Section = { on: false, axis: "y", at: 0, flipped: false };

    constructor() {
        const corners = new THREE.BufferGeometry().setFromPoints(
            [
                [-1, -1],
                [1, -1],
                [1, 1],
                [-1, 1],
            ].map(([x, y]) => new THREE.Vector3(x, y, 0)),
        );
        this.frame = new THREE.LineLoop(corners, new THREE.LineBasicMaterial());
        this.outline = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ depthTest: false, transparent: true }));
        this.outline.frustumCulled = false;
        this.outline.renderOrder = 2;
        const ball = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true });
        this.handle = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 12), ball);
        this.handle.renderOrder = 3;
        this.group.add(this.frame, this.outline, this.handle);
        this.group.visible = false;
    }

    setTheme(theme: Theme): void {
        this.frame.material.color.set(theme.cut);
        this.outline.material.color.set(theme.selected);
        this.handle.material.color.set(theme.cut);
    }

    /** Returns whether a point is hidden by the section. */
    hides(point: THREE.Vector3): boolean {
        return this.section.on && this.plane.distanceToPoint(point) < 0;
    }

    place(section: Section, around: THREE.Box3): void {
        this.section = section;
        this.group.visible = section.on;
        const normal = kAxes[section.axis].clone().multiplyScalar(section.flipped ? 1 : -1);
        this.plane.set(normal, section.flipped ? -section.at : section.at);
        const middle = this.plane.projectPoint(around.getCenter(new THREE.Vector3()), new THREE.Vector3());
        for (const part of [this.frame, this.handle]) {
            part.position.copy(middle);
        }
        // The frame extends slightly beyond the scene. Its x and y are along two of the axes.
        const size = around.getSize(new THREE.Vector3());
        const margin = Math.max(size.length() * kMargin, 1e-3);
        const [across, up] = { x: [size.z, size.y], y: [size.x, size.z], z: [size.x, size.y] }[section.axis];
        this.frame.quaternion.setFromUnitVectors(kAxes.z, kAxes[section.axis]);
        this.frame.scale.set(across / 2 + margin, up / 2 + margin, 1);
    }

    /** Draws the outline of the cut. */
    trace(meshes: THREE.Mesh[]): void {
        const parts = meshes.map((mesh) => {
            const { position, index } = { position: mesh.geometry.getAttribute("position"), index: mesh.geometry.index };
            const constant = this.plane.constant + this.plane.normal.dot(mesh.getWorldPosition(new THREE.Vector3()));
            const range = mesh.geometry.drawRange.count;
            const used = index ? (index.array as Uint32Array).subarray(0, Math.min(range, index.count)) : [];
            const ends = cutTriangles(position.array as Float32Array, used, this.plane.normal, constant);
            const from = mesh.getWorldPosition(new THREE.Vector3());
            for (let i = 0; i < ends.length; i += 3) {
                ends[i] += from.x;
                ends[i + 1] += from.y;
                ends[i + 2] += from.z;
            }
            return ends;
        });
        const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
        let at = 0;
        for (const part of parts) {
            all.set(part, at);
            at += part.length;
        }
        this.outline.geometry.dispose();
        this.outline.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(all, 3));
    }

    scaleHandle(size: number): void {
        this.handle.scale.setScalar(size * 7);
    }

    get middle(): THREE.Vector3 {
        return this.handle.position;
    }

    grabs(x: number, y: number, at: [number, number, number]): boolean {
        return this.section.on && Math.hypot(at[0] - x, at[1] - y) <= kReach;
    }

    /** The section moved so that its centre is closest to a ray. */
    dragged(origin: THREE.Vector3, direction: THREE.Vector3): Section {
        const axis = kAxes[this.section.axis];
        const offset = origin.clone().sub(this.middle);
        const across = axis.dot(direction);
        const span = 1 - across * across;
        if (span < 1e-6) {
            return this.section; // a view along the axis shows no movement
        }
        const along = (axis.dot(offset) - across * direction.dot(offset)) / span;
        return { ...this.section, at: this.section.at + along };
    }
}
