// The field of a solid on a plane: colours, isolines and the line of the surface.
import { effect } from "@preact/signals-core";
import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { Engine, Geometry, Store } from "../app";
import { EngineError } from "../app";
import type { SliceHeader } from "../protocol";
import { paintTexels } from "./colors";
import type { Display, Slice } from "./display";
import { isolines, isoLevels, type Samples } from "./isolines";
import { shortNumber } from "./lengths";
import type { Theme } from "./theme";

const kFaintest = 0.12; // opacity of the minimum values
const kFade = 4;

export class FieldSlice {
    readonly group = new THREE.Group();
    private readonly plane = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, toneMapped: false, transparent: true });
    private readonly thin = new THREE.LineBasicMaterial({ color: "#101418", transparent: true, opacity: 0.55, toneMapped: false });
    private readonly thick = new LineMaterial({ linewidth: 3, toneMapped: false });
    private shown: Geometry | null = null;
    private isRequesting = false;
    private wanted = ""; // key of the requested slice; empty: no slice
    private drawn = "";

    constructor(
        private readonly engine: Engine,
        private readonly store: Store,
        private readonly display: Display,
        private readonly changed: () => void,
    ) {
        this.plane.polygonOffset = true; // offset for the lines
        this.plane.polygonOffsetFactor = 1;
        this.plane.polygonOffsetUnits = 2;
        effect(() => this.follow(display.slice.value, store.state.value.objects));
    }

    setTheme(theme: Theme): void {
        this.thick.color.set(theme.selected);
    }

    private follow(slice: Slice, objects: readonly { kind: string; name: string; version: number }[]): void {
        const solid = objects.find(({ kind, name }) => kind === "solid" && name === slice.solid);
        this.wanted = slice.on && solid ? `${solid.name} ${solid.version} ${slice.axis} ${slice.at}` : "";
        if (this.wanted === "") {
            this.clear();
        } else if (this.wanted === this.drawn) {
            this.draw(); // other lines
        } else {
            void this.request();
        }
    }

    // One at a time: a newer position is requested after the answer.
    private async request(): Promise<void> {
        if (this.isRequesting || this.wanted === this.drawn || this.wanted === "") {
            return;
        }
        this.isRequesting = true;
        const requested = this.wanted;
        const { solid, axis, at } = this.display.slice.peek();
        try {
            const { key } = await this.engine.request<{ key: string }>("slice", { kind: "solid", name: solid, axis, at });
            const geometry = await this.engine.blob(key);
            if (this.wanted !== "") {
                this.shown = geometry;
                this.drawn = requested;
                this.draw();
            }
        } catch (error) {
            this.drawn = requested; // a repeated request would fail again
            if (!(error instanceof EngineError && ["busy", "cancelled"].includes(error.kind))) {
                this.store.notify(`The field of ${solid} cannot be shown: ${(error as Error).message}`, "warning");
            }
        } finally {
            this.isRequesting = false;
        }
        void this.request();
    }

    private clear(): void {
        this.drawn = "";
        this.shown = null;
        this.empty();
        this.display.sliceLegend.value = null;
        this.changed();
    }

    private empty(): void {
        for (const child of [...this.group.children]) {
            child.removeFromParent();
            (child as THREE.Mesh).geometry.dispose();
        }
        this.plane.map?.dispose();
        this.plane.map = null;
    }

    private draw(): void {
        if (!this.shown) {
            return;
        }
        const header = this.shown.header as unknown as SliceHeader & Geometry["header"];
        const { width, height, low, high, level } = header;
        const samples: Samples = { value: this.shown.arrays.value as Float32Array, width, height };
        const place = placeOf(header);
        this.empty();
        this.group.position.set(...header.origin);
        this.group.add(this.picture(samples, { low, high }, place));
        const { solid, lines } = this.display.slice.peek();
        const thin = isoLevels(low, high, level, lines).flatMap((value) => isolines(samples, value));
        const thinLines = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(place(thin), 3));
        const surface = new LineSegmentsGeometry().setPositions(place(isolines(samples, level)));
        const both = [new THREE.LineSegments(thinLines, this.thin), new LineSegments2(surface, this.thick)];
        for (const line of both) {
            line.frustumCulled = false;
        }
        this.group.add(...both.filter((line) => line.geometry.getAttribute("position").count > 0));
        const mark = { value: level, label: `surface: ${shortNumber(level)}` };
        this.display.sliceLegend.value = { title: `Field of ${solid}`, unit: "", low, high, map: "even", mark };
        this.changed();
    }

    private picture({ value, width, height }: Samples, range: { low: number; high: number }, place: Place): THREE.Mesh {
        const colors = paintTexels(value, range);
        const scale = 1 / (range.high - range.low || 1);
        value.forEach((v, i) => {
            colors[4 * i + 3] = 255 * Math.min(kFaintest + kFade * (v - range.low) * scale, 1); // the scene is visible where there is no field
        });
        const texture = new THREE.DataTexture(colors, width, height);
        texture.colorSpace = THREE.SRGBColorSpace;
        texture.magFilter = THREE.LinearFilter;
        texture.minFilter = THREE.LinearFilter;
        texture.needsUpdate = true;
        if (this.plane.map === null) {
            this.plane.needsUpdate = true;
        }
        this.plane.map = texture;
        const quad = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(place([0, 0, 1, 0, 1, 1, 0, 1]), 3));
        // Samples are at the centres of texels, the outermost ones on the border of the plane.
        const [u, v] = [0.5 / width, 0.5 / height];
        quad.setAttribute("uv", new THREE.BufferAttribute(new Float32Array([u, v, 1 - u, v, 1 - u, 1 - v, u, 1 - v]), 2));
        quad.setIndex([0, 1, 2, 0, 2, 3]);
        return new THREE.Mesh(quad, this.plane);
    }
}

type Place = (uv: readonly number[]) => Float32Array<ArrayBuffer>;

/** Converts plane coordinates in [0, 1] to positions in the scene, relative to its origin. */
function placeOf({ corner, along, up }: SliceHeader): Place {
    return (uv) => {
        const out = new Float32Array((uv.length / 2) * 3);
        for (let i = 0; i < uv.length / 2; ++i) {
            for (let c = 0; c < 3; ++c) {
                out[3 * i + c] = corner[c] + along[c] * uv[2 * i] + up[c] * uv[2 * i + 1];
            }
        }
        return out;
    };
}
