// One object of the document in the view.
import * as THREE from "three";
import type { Geometry } from "../app";
import type { ObjectName } from "../protocol";
import { paint, type Range } from "./colors";
import type { Coloring, Display } from "./display";
import { treeOf } from "./extent";
import { type Drawable, drawBones, drawCage, drawCurve, drawPoints } from "./marks";
import { withTriangles } from "./picking/indexer";
import { type HeldMaps, setMaps } from "./materials";
import { edgeLines } from "./picking/triangles";
import { SurfaceModel } from "./surface";
import type { Theme } from "./theme";
import { kManySegments, kRoughness, type ShadedMaterial, TubeModel } from "./tubes";
import { kMeanings, rangeOf, union, valuesOf } from "./values";

export type Slot = "surface" | "axes" | "points" | "curve" | "cage";

const kGlass = 0.3; // opacity of a transparent solid
const kFaintGlass = 0.12; // the same around objects with meaningful colours
const kManyTriangles = 150000; // surfaces with more triangles are replaced by capsules while the view moves

/** Settings that affect the drawing of every object. */
export interface Look {
    display: Display;
    theme: Theme;
    glass: boolean; // solids are transparent
    moving: boolean; // of a view that is too slow to move completely
    clip: THREE.Plane[];
    range: Range | null; // common range of the colours of all objects
    wire: THREE.LineBasicMaterial;
    faintWire: THREE.LineBasicMaterial; // of transparent solids, where all lines are visible at once
}

export function keyOf(object: ObjectName): string {
    return `${object.kind}:${object.name}`;
}

export class ObjectView {
    readonly group = new THREE.Group();
    readonly geometries = new Map<Slot, Geometry>(); // last received geometry
    surface: SurfaceModel | null = null;
    isWood: boolean; // bark material instead of plaster
    source: ObjectView | null = null; // of a mesh: its source skeleton; its branches are picked on the mesh
    private images: HeldMaps | null = null; // of its material
    private tubes: TubeModel | null = null;
    private tubesRange: Range | null = null;
    private bones: Drawable | null = null;
    private marks = new Map<Slot, Drawable>();
    private look: Look | null = null;
    private tint: THREE.ColorRepresentation | null = null;
    private isStale = false;
    private isCovered = false;

    constructor(
        readonly object: ObjectName,
        private readonly changed: () => void,
    ) {
        this.group.name = keyOf(object);
        this.isWood = object.kind === "skeleton";
    }

    put(slot: Slot, geometry: Geometry, look: Look): void {
        const { kind } = geometry.header;
        if (kind === "patch") {
            return; // patches are handled by `patch`
        }
        if (slot === "surface") {
            this.geometries.set(slot, geometry);
            withTriangles(geometry.arrays.quads as Uint32Array | undefined, (index) => {
                if (this.geometries.get(slot) === geometry) {
                    this.putSurface(geometry, look, index);
                }
            });
            return;
        }
        this.geometries.set(slot, geometry);
        if (slot === "axes") {
            this.dropTubes();
        } else {
            this.marks.get(slot)?.object.removeFromParent();
            this.marks.get(slot)?.dispose();
            this.marks.delete(slot);
        }
        this.apply(look);
    }

    /** Applies a patch to the drawn surface if it fits. Returns whether it does. */
    patch(geometry: Geometry, look: Look): boolean {
        if (!this.surface?.patch(geometry)) {
            return false;
        }
        this.geometries.set("surface", this.surface.geometry());
        this.apply(look);
        return true;
    }

    /** Draws the surface with the images of a material, which it releases when it no longer needs them. */
    dress(images: HeldMaps | null, look: Look): void {
        const before = this.images;
        this.images = images;
        this.apply(look);
        before?.release();
    }

    drop(slot: Slot): void {
        this.geometries.delete(slot);
        if (slot === "surface") {
            this.dropSurface();
        }
        this.marks.get(slot)?.object.removeFromParent();
        this.marks.get(slot)?.dispose();
        this.marks.delete(slot);
    }

    /** Whether the surface is older than the skeleton, so that capsules are more accurate. */
    setStale(stale: boolean, look: Look): void {
        if (stale !== this.isStale) {
            this.isStale = stale;
            this.apply(look);
        }
    }

    /** Whether its surface is too large for a moving view. */
    isTooSlow(look: Look): boolean {
        return look.moving && (this.surface?.triangleCount ?? 0) > kManyTriangles;
    }

    /** Whether another object is drawn in its place. */
    setCovered(covered: boolean, look: Look): void {
        if (covered !== this.isCovered) {
            this.isCovered = covered;
            this.apply(look);
        }
    }

    /** Returns whether the tint has changed. */
    setTint(tint: THREE.ColorRepresentation | null): boolean {
        const before = this.tint;
        this.tint = tint;
        for (const material of [...(this.surface?.materials ?? []), ...(this.tubes ? [this.tubes.mesh.material] : [])]) {
            material.emissive.set(tint ?? "black");
            material.emissiveIntensity = tint ? 0.3 : 1;
        }
        return tint !== before;
    }

    /** Draws with the settings. */
    apply(look: Look): void {
        this.look = look;
        const { display, theme } = look;
        const needsTubes = this.geometries.has("axes") && this.showsTubes(look) && !this.isCovered;
        const isRepainted = this.tubesRange?.low !== look.range?.low || this.tubesRange?.high !== look.range?.high;
        if (needsTubes && (isRepainted || this.tubes?.isLight !== this.needsLight(look))) {
            this.dropTubes();
        }
        if (needsTubes && !this.tubes) {
            this.makeTubes(look);
        }
        if (this.tubes) {
            this.tubes.group.visible = needsTubes;
            this.setMaterial(this.tubes.mesh, this.tubes.mesh.material, look);
            this.tubes.follow();
        }
        if (this.surface) {
            this.surface.group.visible = !this.isCovered && !needsTubes && (this.object.kind !== "skeleton" || display.skeletons.peek() === "surface");
            const { surface } = this;
            const isPainted = surface.paint(look.range, kMeanings[display.color.peek()]?.map ?? "even");
            surface.materials.forEach((material, slot) => {
                if (isPainted) {
                    material.needsUpdate = true;
                }
                material.vertexColors = surface.mesh.geometry.hasAttribute("color");
                setMaps(material, this.showsImages(look) ? (this.images?.maps[slot] ?? {}) : {});
                this.setMaterial(surface.mesh, material, look);
            });
            const wire = this.object.kind === "solid" && look.glass ? look.faintWire : look.wire;
            this.surface.setWireframe(display.wireframe.peek() ? wire : null);
        }
        this.applyBones(look);
        for (const slot of ["points", "curve", "cage"] as const) {
            const geometry = this.geometries.get(slot);
            if (geometry && !this.marks.has(slot)) {
                const drawn = this.drawMark(slot, geometry, theme, display.pointSize.peek());
                this.marks.set(slot, drawn);
                this.group.add(drawn.object);
            }
        }
        const points = this.marks.get("points");
        if (points) {
            points.object.visible = display.points.peek();
        }
        for (const drawn of [...this.marks.values(), this.bones]) {
            drawn?.object.traverse((part) => clip(part, look.clip));
        }
        this.setTint(this.tint);
        this.changed();
    }

    /** The range of the coloured values of this object. */
    range(color: Coloring): Range | null {
        return (["surface", "axes"] as const)
            .map((slot) => this.geometries.get(slot))
            .reduce<Range | null>((all, geometry) => union(all, geometry ? rangeOf(geometry, color) : null), null);
    }

    /** Discards the marks, so that they are redrawn. */
    redraw(look: Look): void {
        for (const [, drawn] of this.marks) {
            drawn.object.removeFromParent();
            drawn.dispose();
        }
        this.marks.clear();
        this.dropTubes();
        this.apply(look);
    }

    dispose(): void {
        this.group.removeFromParent();
        this.dropSurface();
        this.images?.release();
        this.dropTubes();
        this.marks.forEach((drawn) => drawn.dispose());
        this.marks.clear();
        this.geometries.clear();
    }

    get triangleCount(): number {
        return this.surface?.group.visible ? this.surface.triangleCount : 0;
    }

    private showsTubes(look: Look): boolean {
        if (this.object.kind !== "skeleton" || look.display.skeletons.peek() === "lines") {
            return false;
        }
        return look.display.skeletons.peek() === "tubes" || !this.surface || this.isStale || this.isTooSlow(look);
    }

    // Objects that move or are out of date are drawn in the fast form.
    private needsLight(look: Look): boolean {
        const segments = this.geometries.get("axes")?.arrays.parent.length ?? 0;
        return segments > kManySegments && (look.moving || this.isStale);
    }

    private applyBones(look: Look): void {
        const axes = this.geometries.get("axes");
        const isWanted = axes !== undefined && (look.display.bones.peek() || look.display.skeletons.peek() === "lines");
        if (isWanted && axes && !this.bones) {
            this.bones = drawBones(axes, treeOf(axes), look.theme.bones);
            this.group.add(this.bones.object);
        } else if (!isWanted && this.bones) {
            this.bones.object.removeFromParent();
            this.bones.dispose();
            this.bones = null;
        }
    }

    private drawMark(slot: "points" | "curve" | "cage", geometry: Geometry, theme: Theme, size: number): Drawable {
        switch (slot) {
            case "points":
                return drawPoints(geometry, theme.mark, size);
            case "curve":
                return drawCurve(geometry, theme.mark, theme.control);
            case "cage": {
                const { quads, triangles } = geometry.arrays as Record<string, Uint32Array | undefined>;
                return drawCage(geometry, quads ? edgeLines(quads, 4) : edgeLines(triangles ?? new Uint32Array(0), 3), theme.control);
            }
        }
    }

    private setMaterial(mesh: THREE.Mesh, material: ShadedMaterial, look: Look): void {
        const { kind } = this.object;
        const isCut = look.clip.length > 0;
        const isGlass = kind === "solid" && look.glass;
        const side = kind === "mesh" || isCut ? THREE.DoubleSide : THREE.FrontSide;
        if (material.transparent !== isGlass || material.side !== side || material.clippingPlanes?.length !== look.clip.length) {
            material.needsUpdate = true;
        }
        material.side = side;
        material.transparent = isGlass;
        material.opacity = !isGlass ? 1 : look.range ? kFaintGlass : kGlass;
        material.depthWrite = !isGlass;
        material.clippingPlanes = look.clip;
        material.clipShadows = isCut;
        material.color.set(material.vertexColors || material.map ? "white" : this.baseColor(look));
        mesh.castShadow = !isGlass;
        mesh.renderOrder = isGlass ? 1 : 0;
        material.polygonOffset = look.display.wireframe.peek(); // offset for the lines
        material.polygonOffsetFactor = 1;
        material.polygonOffsetUnits = 1;
    }

    private showsImages({ display }: Look): boolean {
        return display.color.peek() === "plain" && this.surface?.mesh.geometry.hasAttribute("uv") === true;
    }

    private baseColor({ theme, display }: Look): string {
        const { kind } = this.object;
        if (kind === "solid") {
            return theme.solid;
        }
        return this.isWood && display.color.peek() !== "crossings" ? theme.bark : theme.mesh; // marks are most visible on grey
    }

    private makeTubes(look: Look): void {
        const axes = this.geometries.get("axes");
        if (axes) {
            const color = look.display.color.peek();
            const values = valuesOf(axes, color);
            const colors = values && look.range ? paint(values, look.range, kMeanings[color]?.map) : undefined;
            this.tubes = new TubeModel(axes, treeOf(axes), this.needsLight(look), colors);
            this.tubesRange = look.range;
            this.group.add(this.tubes.group);
        }
    }

    private putSurface(geometry: Geometry, look: Look, index?: Uint32Array): void {
        this.dropSurface();
        const slots = geometry.header.slots ?? [0];
        const materials = slots.map(() => cutShader(look.theme));
        this.surface = new SurfaceModel(geometry.header, geometry.arrays, materials, index);
        this.group.add(this.surface.group);
        this.isStale = false;
        this.apply(this.look ?? look);
    }

    private dropSurface(): void {
        this.surface?.group.removeFromParent();
        this.surface?.dispose();
        this.surface = null;
    }

    private dropTubes(): void {
        this.tubes?.group.removeFromParent();
        this.tubes?.dispose();
        this.tubes = null;
        this.bones?.object.removeFromParent();
        this.bones?.dispose();
        this.bones = null;
    }
}

function clip(part: THREE.Object3D, planes: THREE.Plane[]): void {
    const { material } = part as THREE.Mesh;
    if (material instanceof THREE.Material) {
        material.clippingPlanes = planes;
    }
}

// The inside of a closed surface that is cut open is drawn flat, as if the solid were full.
function cutShader(theme: Theme): THREE.MeshStandardMaterial {
    const material = new THREE.MeshStandardMaterial({ roughness: kRoughness });
    const cut = new THREE.Color(theme.cut);
    material.onBeforeCompile = (shader) => {
        shader.uniforms.cutColor = { value: cut };
        shader.uniforms.ownColor = { value: material.color };
        shader.fragmentShader = shader.fragmentShader.replace("#include <common>", "#include <common>\nuniform vec3 cutColor;\nuniform vec3 ownColor;").replace(
            "#include <opaque_fragment>",
            `#include <opaque_fragment>
                #if NUM_CLIPPING_PLANES > 0
                    if (!gl_FrontFacing) gl_FragColor = vec4(mix(ownColor, cutColor, 0.6), 1.0);
                #endif`,
        );
    };
    material.customProgramCacheKey = () => "surface";
    return material;
}
