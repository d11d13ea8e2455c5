// Marks at self-intersections of surfaces.
import * as THREE from "three";
import type { Point } from "../protocol";
import type { Crossing } from "./display";
import { discs } from "./marks";
import type { Theme } from "./theme";

const kSizes = { rim: 15, core: 10, chosen: 24 }; // [px]

export class CrossingMarks {
    readonly group = new THREE.Group();
    private shown: readonly Crossing[] = [];
    private chosen = -1;
    private readonly rim = discs("#ffffff", kSizes.rim, true);
    private readonly core = discs("#d4213d", kSizes.core, true);
    private readonly ring = discs("#ffffff", kSizes.chosen, true);

    constructor() {
        this.ring.opacity = 0.75;
    }

    setTheme(theme: Theme): void {
        this.ring.color.set(theme.selected);
    }

    show(crossings: readonly Crossing[], chosen: number): void {
        if (crossings === this.shown && chosen === this.chosen) {
            return;
        }
        this.shown = crossings;
        this.chosen = chosen;
        for (const child of [...this.group.children]) {
            child.removeFromParent();
            (child as THREE.Points).geometry.dispose();
        }
        const places = crossings.map(({ at }) => at);
        this.put(places.slice(chosen, chosen < 0 ? 0 : chosen + 1), this.ring, 3);
        this.put(places, this.rim, 4);
        this.put(places, this.core, 5);
    }

    private put(places: readonly Point[], material: THREE.PointsMaterial, order: number): void {
        if (places.length === 0) {
            return;
        }
        const lines = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(places.flat()), 3));
        const points = new THREE.Points(lines, material);
        points.frustumCulled = false;
        points.renderOrder = order;
        this.group.add(points);
    }
}
