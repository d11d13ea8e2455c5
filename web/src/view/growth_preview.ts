// Intermediate result of a running growth.
import * as THREE from "three";
import type { Engine, Geometry } from "../app";
import { treeOf } from "./extent";
import type { Theme } from "./theme";
import { kManySegments, TubeModel } from "./tubes";

const kNone = 0xffffffff;
const kPipe = 2.5; // the same as in `radii`

/**
 * Growth gives every node the radius of a tip. The pipe model sums radii from the tips down, so that the trunk is visible.
 * Parents come first.
 */
export function pipeRadii(parent: Uint32Array, radius: Float32Array): Float32Array {
    const tips = new Float64Array(parent.length);
    for (let n = parent.length - 1; n >= 0; --n) {
        tips[n] = Math.max(tips[n], 1);
        if (parent[n] !== kNone) {
            tips[parent[n]] += tips[n];
        }
    }
    return radius.map((tip, n) => tip * tips[n] ** (1 / kPipe));
}

export class GrowthPreview {
    readonly group = new THREE.Group();
    private model: TubeModel | null = null;
    private wanted: string | null = null; // newer than the current request
    private isFetching = false;
    private round = 0; // number of the growth: results of an older one are not shown

    constructor(
        private readonly engine: Engine,
        private readonly changed: () => void,
        private readonly turn = () => new Promise((next) => requestAnimationFrame(next)),
    ) {}

    /** Shows the newest result; results that arrive during a request are skipped, since growth may be faster. */
    show(key: string, theme: Theme): void {
        this.wanted = key;
        if (!this.isFetching) {
            void this.fetch(theme);
        }
    }

    clear(): void {
        ++this.round;
        this.wanted = null;
        this.drop();
    }

    private async fetch(theme: Theme): Promise<void> {
        this.isFetching = true;
        while (this.wanted !== null) {
            await this.turn(); // newer waiting results have priority
            const { wanted, round } = this;
            this.wanted = null;
            const geometry = wanted && (await this.engine.blob(wanted).catch(() => null)); // null: empty, since another growth has begun
            if (geometry && round === this.round) {
                this.draw(geometry, theme);
            }
        }
        this.isFetching = false;
    }

    private draw(geometry: Geometry, theme: Theme): void {
        this.drop();
        const { parent, radius } = geometry.arrays as { parent: Uint32Array; radius: Float32Array };
        const piped = { ...geometry, arrays: { ...geometry.arrays, radius: pipeRadii(parent, radius) } };
        const tree = treeOf(piped);
        this.model = new TubeModel(piped, tree, tree.parent.length > kManySegments);
        this.model.mesh.material.color.set(theme.bark);
        this.model.follow();
        this.group.add(this.model.group);
        this.changed();
    }

    private drop(): void {
        this.model?.group.removeFromParent();
        this.model?.dispose();
        this.model = null;
    }
}
