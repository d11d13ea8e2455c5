// Segments of a skeleton as tapered capsules, one instance each.
import * as THREE from "three";
import type { Geometry } from "../app";
import { innerRadius, type Tree } from "./extent";

const kNone = 0xffffffff;

/** Extends the shader of a material to draw capsules; for onBeforeCompile. */
export function asTubes(material: THREE.Material): void {
    material.onBeforeCompile = (shader) => {
        shader.vertexShader = shader.vertexShader
            .replace(
                "#include <common>",
                `#include <common>
                attribute vec3 tubeA;
                attribute vec3 tubeB;
                attribute vec2 tubeRadius;
                attribute float tubeEnd;
                uniform float tubeInflate;
                vec3 tubeDirection() {
                    vec3 along = tubeB - tubeA;
                    float size = length(along);
                    vec3 w = size > 0.0 ? along / size : vec3(0.0, 0.0, 1.0);
                    vec3 u = normalize(abs(w.z) < 0.9 ? cross(vec3(0.0, 0.0, 1.0), w) : cross(vec3(1.0, 0.0, 0.0), w));
                    return u * position.x + cross(w, u) * position.y + w * position.z;
                }`,
            )
            .replace("#include <beginnormal_vertex>", "vec3 objectNormal = tubeDirection();")
            .replace(
                "#include <begin_vertex>",
                `vec3 transformed = mix(tubeA, tubeB, tubeEnd)
                + tubeDirection() * mix(tubeRadius.x, tubeRadius.y, tubeEnd) * tubeInflate;`,
            );
        shader.uniforms.tubeInflate = { value: (material.userData.inflate as number | undefined) ?? 1 };
    };
    material.customProgramCacheKey = () => "tubes";
}

interface Capsule {
    position: THREE.Float32BufferAttribute;
    end: THREE.Float32BufferAttribute;
    index: THREE.Uint16BufferAttribute;
}

// Rings of a capsule along its axis: distance from the axis, position along it, and its end.
const kRound: [number, number, number][] = [
    [0, -1, 0],
    [0.71, -0.71, 0],
    [1, 0, 0],
    [1, 0, 1],
    [0.71, 0.71, 1],
    [0, 1, 1],
];
const kPlain: [number, number, number][] = [
    [0, -1, 0],
    [1, 0, 0],
    [1, 0, 1],
    [0, 1, 1],
];

function capsule(rings: [number, number, number][], sides: number): Capsule {
    const position: number[] = [];
    const end: number[] = [];
    const index: number[] = [];
    rings.forEach(([out, along, which], ring) => {
        for (let k = 0; k < sides; ++k) {
            const angle = (2 * Math.PI * k) / sides;
            position.push(out * Math.cos(angle), out * Math.sin(angle), along);
            end.push(which);
            if (ring > 0) {
                const next = (k + 1) % sides;
                const [a, b] = [(ring - 1) * sides + k, (ring - 1) * sides + next];
                const [c, d] = [ring * sides + next, ring * sides + k];
                index.push(a, b, c, a, c, d);
            }
        }
    });
    return {
        position: new THREE.Float32BufferAttribute(position, 3),
        end: new THREE.Float32BufferAttribute(end, 1),
        index: new THREE.Uint16BufferAttribute(index, 1),
    };
}

const kPipe = capsule(kPlain.slice(1, 3), 6);

// By the number of segments, because vertices are slow without a GPU.
const kLevels: [number, Capsule][] = [
    [1500, capsule(kRound, 10)],
    [8000, capsule(kPlain, 6)],
    [Infinity, capsule(kPlain.slice(1, 3), 4)],
];

/** Capsules for all or some nodes of a skeleton; `colors` by node, four bytes each. */
export function tubeGeometry(geometry: Geometry, tree: Tree, nodes?: number[], colors?: Uint8Array, form?: Capsule): THREE.InstancedBufferGeometry {
    const position = geometry.arrays.position as Float32Array;
    const wanted = nodes ?? Array.from(tree.parent.keys());
    const segments = wanted.filter((n) => tree.parent[n] !== kNone || tree.leader[n] === kNone || nodes?.length === 1);
    const ends = new Float32Array(segments.length * 8);
    const color = colors && new Uint8Array(segments.length * 4);
    segments.forEach((n, i) => {
        const p = tree.parent[n] === kNone ? n : tree.parent[n];
        ends.set(position.subarray(3 * p, 3 * p + 3), 8 * i);
        ends.set(position.subarray(3 * n, 3 * n + 3), 8 * i + 3);
        ends[8 * i + 6] = innerRadius(tree, n);
        ends[8 * i + 7] = tree.radius[n];
        if (color && colors) {
            color.set(colors.subarray(4 * n, 4 * n + 4), 4 * i);
        }
    });
    const shape = form ?? kLevels.find(([most]) => segments.length <= most)?.[1] ?? kLevels[2][1];
    const buffers = new THREE.InstancedBufferGeometry();
    buffers.instanceCount = segments.length;
    buffers.setAttribute("position", shape.position.clone());
    buffers.setAttribute("tubeEnd", shape.end.clone());
    buffers.setIndex(shape.index.clone());
    const both = new THREE.InstancedInterleavedBuffer(ends, 8);
    buffers.setAttribute("tubeA", new THREE.InterleavedBufferAttribute(both, 3, 0));
    buffers.setAttribute("tubeB", new THREE.InterleavedBufferAttribute(both, 3, 3));
    buffers.setAttribute("tubeRadius", new THREE.InterleavedBufferAttribute(both, 2, 6));
    if (color) {
        buffers.setAttribute("color", new THREE.InstancedBufferAttribute(color, 4, true));
    }
    return buffers;
}

/** Skeletons with more segments are simplified if they have to be drawn quickly. */
export const kManySegments = 6000;
const kMaxPipes = 3000; // maximum number of capsules of a simplified skeleton
const kTwigShade = 0.75; // lines have no shaded side

/** Nodes of the thickest segments, and end points of the lines that represent the others. */
export function thickest(tree: Tree, most: number): { thick: number[]; lines: Uint32Array } {
    const { radius, parent } = tree;
    const least = radius.length > most ? radius.slice().sort()[radius.length - most] : 0;
    const thick: number[] = [];
    const lines = new Uint32Array(2 * radius.length);
    let at = 0;
    for (let n = 0; n < radius.length; ++n) {
        if (parent[n] === kNone) {
            continue;
        }
        if (radius[n] >= least && thick.length < most) {
            thick.push(n);
        } else {
            lines[at++] = parent[n];
            lines[at++] = n;
        }
    }
    return { thick, lines: lines.subarray(0, at) };
}

/** Roughness of bark, leaves and plaster. */
export const kRoughness = 0.82;

export type ShadedMaterial = THREE.MeshStandardMaterial | THREE.MeshLambertMaterial;

/** A skeleton as capsules; if `light`, only for the thickest segments, and lines for the others. */
export class TubeModel {
    readonly group = new THREE.Group();
    readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, ShadedMaterial>;
    private twigs: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial> | null = null;

    constructor(
        geometry: Geometry,
        tree: Tree,
        readonly isLight: boolean,
        colors?: Uint8Array,
    ) {
        const material = isLight ? new THREE.MeshLambertMaterial() : new THREE.MeshStandardMaterial({ roughness: kRoughness });
        asTubes(material);
        material.vertexColors = colors !== undefined;
        const { thick, lines } = isLight ? thickest(tree, kMaxPipes) : { thick: undefined, lines: undefined };
        this.mesh = new THREE.Mesh(tubeGeometry(geometry, tree, thick, colors, isLight ? kPipe : undefined), material);
        this.group.position.set(...geometry.header.origin);
        this.mesh.frustumCulled = false;
        this.mesh.castShadow = true;
        this.mesh.receiveShadow = !isLight;
        this.mesh.customDepthMaterial = new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking });
        asTubes(this.mesh.customDepthMaterial);
        this.group.add(this.mesh);
        if (lines) {
            this.addTwigs(geometry, lines, colors);
        }
    }

    /** Updates the lines to the material of the capsules. */
    follow(): void {
        if (this.twigs) {
            const { color, clippingPlanes } = this.mesh.material;
            this.twigs.material.color.copy(color).multiplyScalar(kTwigShade);
            this.twigs.material.clippingPlanes = clippingPlanes;
        }
    }

    dispose(): void {
        this.mesh.geometry.dispose();
        this.mesh.material.dispose();
        this.mesh.customDepthMaterial?.dispose();
        this.twigs?.geometry.dispose();
        this.twigs?.material.dispose();
    }

    private addTwigs(geometry: Geometry, lines: Uint32Array, colors?: Uint8Array): void {
        const buffers = new THREE.BufferGeometry();
        buffers.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
        buffers.setIndex(new THREE.BufferAttribute(lines, 1));
        if (colors) {
            buffers.setAttribute("color", new THREE.BufferAttribute(colors, 4, true));
        }
        this.twigs = new THREE.LineSegments(buffers, new THREE.LineBasicMaterial({ vertexColors: colors !== undefined }));
        this.twigs.frustumCulled = false;
        this.group.add(this.twigs);
    }
}
