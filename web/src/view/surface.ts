// A surface on the GPU, which patches change in place.
import * as THREE from "three";
import type { Geometry } from "../app";
import { type ColorMap, paint, type Range } from "./colors";
import { TriangleTree } from "./picking/triangle_tree";
import { edgeLines, fillTriangles } from "./picking/triangles";

const kSlack = 1.3; // factor of capacity for elements that patches add

function grown<T extends Float32Array | Int8Array | Uint32Array | Uint8Array>(array: T, length: number): T {
    const larger = new (array.constructor as new (length: number) => T)(length);
    larger.set(array as never);
    return larger;
}

export class SurfaceModel {
    readonly group = new THREE.Group();
    readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial | THREE.MeshStandardMaterial[]>;
    private lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial> | null = null;
    private readonly uv: Float32Array | undefined; // of surfaces with a material
    private position: Float32Array;
    private normal: Int8Array;
    private quads: Uint32Array;
    private triangles: Uint32Array;
    private index: Uint32Array;
    private vertexCount: number;
    private quadCount: number;
    private values: Float32Array | undefined; // values for the colours
    private painted: Range | null = null;
    private tree: TriangleTree | null = null; // for picking

    /** `materials`: one, or one for each slot. `index`: triangles of the quads, if a worker has already computed them. */
    constructor(
        private header: Geometry["header"],
        arrays: Geometry["arrays"],
        readonly materials: readonly THREE.MeshStandardMaterial[],
        index?: Uint32Array,
    ) {
        this.position = arrays.position as Float32Array;
        this.normal = arrays.normal as Int8Array;
        this.quads = (arrays.quads as Uint32Array | undefined) ?? new Uint32Array(0);
        this.triangles = (arrays.triangles as Uint32Array | undefined) ?? new Uint32Array(0);
        this.vertexCount = this.position.length / 3;
        this.quadCount = this.quads.length / 4;
        this.index = index && this.triangles.length === 0 ? index : this.makeIndex();
        this.uv = arrays.uv as Float32Array | undefined;
        this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), materials.length === 1 ? materials[0] : [...materials]);
        this.mesh.frustumCulled = false;
        this.mesh.castShadow = true;
        this.mesh.receiveShadow = true;
        this.group.add(this.mesh);
        this.group.position.set(...header.origin);
        this.setAttributes();
        this.values = arrays.value as Float32Array | undefined;
    }

    /** The quantity of its values; "plain": no values. */
    get color(): string {
        return this.values ? (this.header.color ?? "plain") : "plain";
    }

    /** Colours it by its values; null: without colours. Returns whether the vertex colours were added or removed. */
    paint(range: Range | null, map: ColorMap): boolean {
        const wanted = this.values ? range : null;
        const before = this.painted;
        if (wanted?.low === before?.low && wanted?.high === before?.high) {
            return false;
        }
        this.painted = wanted;
        const { geometry } = this.mesh;
        const colors = this.values && wanted ? paint(this.values, wanted, map) : null;
        const drawn = geometry.getAttribute("color") as THREE.BufferAttribute | undefined;
        if (colors && drawn) {
            (drawn.array as Uint8Array).set(colors);
            drawn.needsUpdate = true;
        } else if (colors) {
            geometry.setAttribute("color", new THREE.BufferAttribute(colors, 4, true));
        } else {
            geometry.dispose(); // otherwise the GPU would keep the buffer of the attribute
            geometry.deleteAttribute("color");
        }
        return (wanted === null) !== (before === null);
    }

    get version(): number {
        return this.header.version;
    }

    get triangleCount(): number {
        return this.quadCount * 2 + this.triangles.length / 3;
    }

    /** Its triangles for ray tests, relative to the origin of the surface; built on the first call. */
    triangleTree(): TriangleTree {
        this.tree ??= new TriangleTree(this.position, this.index.subarray(0, this.triangles.length + 6 * this.quadCount));
        return this.tree;
    }

    /** The drawn geometry, as views of the arrays that patches change. */
    geometry(): Geometry {
        return {
            header: this.header,
            arrays: {
                position: this.position.subarray(0, 3 * this.vertexCount),
                normal: this.normal.subarray(0, 4 * this.vertexCount),
                quads: this.quads.subarray(0, 4 * this.quadCount),
                triangles: this.triangles,
            },
        };
    }

    /** Applies a patch of the drawn surface. Returns whether the patch fits. */
    patch(patch: Geometry): boolean {
        const { base, ranges, vertices, quads, version } = patch.header;
        if (base !== this.header.version || !ranges || vertices === undefined || quads === undefined) {
            return false;
        }
        this.reserve(vertices, quads);
        this.vertexCount = vertices;
        this.quadCount = quads;
        const { position, normal } = patch.arrays;
        let from = 0;
        for (const [first, count] of ranges.vertices) {
            this.position.set(position.subarray(3 * from, 3 * (from + count)), 3 * first);
            this.normal.set(normal.subarray(4 * from, 4 * (from + count)), 4 * first);
            this.update("position", 3 * first, 3 * count);
            this.update("normal", 4 * first, 4 * count);
            from += count;
        }
        this.patchQuads(patch.arrays.quads as Uint32Array | undefined, ranges.quads);
        this.mesh.geometry.setDrawRange(0, this.triangles.length + 6 * quads);
        this.values = undefined;
        this.paint(null, "even");
        this.tree = null;
        this.header = { ...this.header, version };
        return true;
    }

    setWireframe(material: THREE.LineBasicMaterial | null): void {
        if (!material) {
            this.dropLines();
        } else if (!this.lines) {
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute("position", this.mesh.geometry.getAttribute("position"));
            const quadLines = edgeLines(this.quads.subarray(0, 4 * this.quadCount), 4);
            const otherLines = edgeLines(this.triangles, 3);
            const both = new Uint32Array(quadLines.length + otherLines.length);
            both.set(quadLines);
            both.set(otherLines, quadLines.length);
            geometry.setIndex(new THREE.BufferAttribute(both, 1));
            this.lines = new THREE.LineSegments(geometry, material);
            this.lines.frustumCulled = false;
            this.group.add(this.lines);
        } else {
            this.lines.material = material;
        }
    }

    dispose(): void {
        this.dropLines();
        this.mesh.geometry.dispose();
        this.materials.forEach((material) => material.dispose());
    }

    private patchQuads(quads: Uint32Array | undefined, ranges: [number, number][]): void {
        if (!quads || ranges.length === 0) {
            return;
        }
        const index = this.index.subarray(this.triangles.length);
        let from = 0;
        for (const [first, count] of ranges) {
            const part = quads.subarray(4 * from, 4 * (from + count));
            this.quads.set(part, 4 * first);
            fillTriangles(part, index, first);
            const attribute = this.mesh.geometry.index as THREE.BufferAttribute;
            attribute.addUpdateRange(this.triangles.length + 6 * first, 6 * count);
            attribute.needsUpdate = true;
            from += count;
        }
        this.dropLines(); // the edges have changed; the next setting recreates the lines
    }

    // The triangles precede those of the quads, because the number of quads changes.
    private makeIndex(): Uint32Array {
        const index = new Uint32Array(this.triangles.length + (this.quads.length / 4) * 6);
        index.set(this.triangles);
        fillTriangles(this.quads, index.subarray(this.triangles.length), 0);
        return index;
    }

    private reserve(vertices: number, quads: number): void {
        const moreVertices = 3 * vertices > this.position.length;
        const moreQuads = 4 * quads > this.quads.length;
        if (!moreVertices && !moreQuads) {
            return;
        }
        if (moreVertices) {
            const room = Math.ceil(vertices * kSlack);
            this.position = grown(this.position, 3 * room);
            this.normal = grown(this.normal, 4 * room);
        }
        if (moreQuads) {
            const room = Math.ceil(quads * kSlack);
            this.quads = grown(this.quads, 4 * room);
            this.index = grown(this.index, this.triangles.length + 6 * room);
        }
        this.dropLines();
        this.mesh.geometry.dispose();
        this.setAttributes();
    }

    private setAttributes(): void {
        const geometry = this.mesh.geometry;
        const changing = (attribute: THREE.BufferAttribute) => attribute.setUsage(THREE.DynamicDrawUsage);
        geometry.setAttribute("position", changing(new THREE.BufferAttribute(this.position, 3)));
        geometry.setAttribute("normal", changing(new THREE.BufferAttribute(this.normal, 4, true)));
        if (this.uv) {
            geometry.setAttribute("uv", new THREE.BufferAttribute(this.uv, 2)); // patches are only for surfaces without it
        }
        geometry.setIndex(changing(new THREE.BufferAttribute(this.index, 1)));
        geometry.setDrawRange(0, this.triangles.length + 6 * this.quadCount);
        this.setGroups();
    }

    // Surfaces with slots consist of quads or of triangles, sorted by slot.
    private setGroups(): void {
        const { geometry } = this.mesh;
        const corners = this.triangles.length > 0 ? 3 : 6;
        let first = 0;
        geometry.clearGroups();
        if (this.materials.length > 1) {
            (this.header.slots ?? []).forEach((count, slot) => {
                geometry.addGroup(first, corners * count, slot);
                first += corners * count;
            });
        }
    }

    private update(name: string, first: number, count: number): void {
        const attribute = this.mesh.geometry.getAttribute(name) as THREE.BufferAttribute;
        attribute.addUpdateRange(first, count);
        attribute.needsUpdate = true;
    }

    private dropLines(): void {
        if (this.lines) {
            this.lines.removeFromParent();
            this.lines.geometry.deleteAttribute("position"); // the attribute belongs to the mesh
            this.lines.geometry.dispose();
            this.lines = null;
        }
    }
}
