// Nodes under the pointer and selected nodes, drawn over the surfaces of skeletons.
import * as THREE from "three";
import type { Geometry, Selection } from "../app";
import { extentOf, treeOf } from "./extent";
import { asTubes, tubeGeometry } from "./tubes";

const kInflate = 1.12;

function tubeMaterial(): THREE.MeshBasicMaterial {
    const material = new THREE.MeshBasicMaterial();
    material.polygonOffset = true;
    material.polygonOffsetFactor = -2;
    material.polygonOffsetUnits = -8;
    material.userData.inflate = kInflate;
    asTubes(material);
    return material;
}

/** Some nodes of one skeleton, in one colour. */
export class Highlight {
    readonly group = new THREE.Group();
    private readonly material = tubeMaterial();
    // Overlapping capsules would draw the glow twice; so their depth is drawn first, and then only the front.
    private readonly depth = tubeMaterial();
    private geometry: THREE.BufferGeometry = new THREE.InstancedBufferGeometry();
    private readonly meshes: THREE.Mesh[];
    private shown: { geometry?: Geometry; extent?: Selection["extent"]; ids?: number[]; first?: number } = {};

    constructor(opacity: number) {
        this.depth.colorWrite = false;
        this.depth.transparent = true; // drawn after opaque objects
        Object.assign(this.material, { transparent: true, opacity, depthWrite: false, depthFunc: THREE.EqualDepth });
        this.meshes = [this.depth, this.material].map((material, i) => {
            const mesh = new THREE.Mesh(this.geometry, material);
            mesh.frustumCulled = false;
            mesh.renderOrder = 0.5 + i / 10;
            return mesh;
        });
        this.group.add(...this.meshes);
        this.group.visible = false;
    }

    setColor(color: string): void {
        this.material.color.set(color);
    }

    clip(planes: THREE.Plane[]): void {
        this.material.clippingPlanes = planes;
        this.depth.clippingPlanes = planes;
    }

    /** Returns whether the drawn nodes have changed. */
    show(geometry: Geometry | undefined, ids: number[], extent: Selection["extent"]): boolean {
        const before = this.shown;
        // An extent around a node begins at the same node for all of its nodes.
        const first = geometry && ids.length === 1 ? extentOf(treeOf(geometry), ids[0], extent)[0] : undefined;
        const isSame = ids === before.ids || (first !== undefined && first === before.first) || (ids.length === 0 && before.ids?.length === 0);
        if (geometry === before.geometry && extent === before.extent && isSame) {
            return false;
        }
        this.shown = { geometry, ids, extent, first };
        this.group.visible = false;
        if (geometry && ids.length > 0) {
            const tree = treeOf(geometry);
            const nodes = [...new Set(ids.flatMap((id) => extentOf(tree, id, extent)))];
            this.geometry.dispose();
            this.geometry = tubeGeometry(geometry, tree, nodes);
            for (const mesh of this.meshes) {
                mesh.geometry = this.geometry;
            }
            this.group.position.set(...geometry.header.origin);
            this.group.visible = nodes.length > 0;
        }
        return true;
    }
}
