// The tree of a sketch in its 3D view.
import * as THREE from "three";
import type { App, Geometry } from "../app";
import { Skeleton } from "../tools/kit/skeleton";
import { kDark, kLight } from "../view/theme";

const kSides = 8;

export class SketchTree {
    private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.85 });
    private mesh: THREE.InstancedMesh | null = null;
    private framed = false;
    private reach = 0; // [m] size of the framed scene

    constructor(private readonly app: App) {}

    show(geometry: Geometry): void {
        this.clear();
        const skeleton = Skeleton.of(geometry);
        const nodes = skeleton.all().filter((n) => skeleton.parent(n) >= 0);
        const shape = new THREE.CylinderGeometry(1, 1, 1, kSides);
        const mesh = new THREE.InstancedMesh(shape, this.material, nodes.length);
        const place = new THREE.Matrix4();
        const up = new THREE.Vector3(0, 1, 0);
        nodes.forEach((n, i) => {
            const to = new THREE.Vector3(...skeleton.at(n));
            const from = new THREE.Vector3(...skeleton.at(skeleton.parent(n)));
            const offset = to.clone().sub(from);
            const turn = new THREE.Quaternion().setFromUnitVectors(up, offset.clone().normalize());
            const radius = skeleton.radius[n];
            place.compose(from.add(to).multiplyScalar(0.5), turn, new THREE.Vector3(radius, offset.length(), radius));
            mesh.setMatrixAt(i, place);
        });
        mesh.frustumCulled = false;
        this.material.color.set(matchMedia("(prefers-color-scheme: light)").matches ? kLight.bark : kDark.bark);
        this.mesh = mesh;
        this.app.view.overlay.add(mesh);
        this.look(skeleton);
        this.app.view.requestDraw();
    }

    // Unless the user has moved the camera, it follows the growing tree.
    private look(skeleton: Skeleton): void {
        const around = new THREE.Box3();
        skeleton.all().forEach((n) => around.expandByPoint(new THREE.Vector3(...skeleton.at(n))));
        const { center, radius } = around.getBoundingSphere(new THREE.Sphere());
        const isOutside = skeleton.all().some((n) => {
            const [x, y, depth] = this.app.view.toPixels(skeleton.at(n));
            const { clientWidth, clientHeight } = this.app.view.element();
            return Math.abs(depth) > 1 || x < 0 || y < 0 || x > clientWidth || y > clientHeight;
        });
        if (!this.framed || (isOutside && radius > this.reach)) {
            this.app.view.frameAround(center.toArray(), radius);
        }
        this.framed = true;
        this.reach = Math.max(this.reach, radius);
    }

    clear(): void {
        if (this.mesh) {
            this.app.view.overlay.remove(this.mesh);
            this.mesh.geometry.dispose();
            this.mesh.dispose();
            this.mesh = null;
            this.app.view.requestDraw();
        }
    }

    stop(): void {
        this.clear();
        this.material.dispose();
    }
}
