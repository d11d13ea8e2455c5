// Points, lines and the control points of curves.
import * as THREE from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { Geometry } from "../app";
import type { Tree } from "./extent";

const kNone = 0xffffffff;

// Points as discs, because squares look like noise.
function asDiscs(material: THREE.PointsMaterial): THREE.PointsMaterial {
    material.onBeforeCompile = (shader) => {
        shader.fragmentShader = shader.fragmentShader.replace(
            "#include <clipping_planes_fragment>",
            "#include <clipping_planes_fragment>\nif (length(gl_PointCoord - 0.5) > 0.5) discard;",
        );
    };
    material.customProgramCacheKey = () => "discs";
    return material;
}

export function discs(color: THREE.ColorRepresentation, size: number, over = false): THREE.PointsMaterial {
    const material = new THREE.PointsMaterial({ color, size: size * Math.min(devicePixelRatio, 2), sizeAttenuation: false });
    if (over) {
        material.depthTest = false;
        material.transparent = true; // drawn after opaque objects
    }
    return asDiscs(material);
}

/** An object that can be drawn and disposed. */
export interface Drawable {
    object: THREE.Object3D;
    dispose(): void;
}

function drawable(object: THREE.Object3D, ...parts: { dispose(): void }[]): Drawable {
    return { object, dispose: () => parts.forEach((part) => part.dispose()) };
}

export function drawPoints(geometry: Geometry, color: THREE.ColorRepresentation, size: number): Drawable {
    const buffers = new THREE.BufferGeometry();
    buffers.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    const colors = geometry.arrays.color as Uint8Array | undefined;
    const material = discs(colors ? "white" : color, size);
    if (colors) {
        buffers.setAttribute("color", new THREE.BufferAttribute(colors, 4, true));
        material.vertexColors = true;
    }
    const points = new THREE.Points(buffers, material);
    points.position.set(...geometry.header.origin);
    points.frustumCulled = false;
    return drawable(points, buffers, material);
}

export function drawCurve(geometry: Geometry, color: THREE.ColorRepresentation, controlColor: THREE.ColorRepresentation): Drawable {
    const group = new THREE.Group();
    group.position.set(...geometry.header.origin);
    const position = geometry.arrays.position as Float32Array;
    const line = new LineGeometry();
    line.setPositions(geometry.header.closed ? [...position, ...position.subarray(0, 3)] : position);
    const material = new LineMaterial({ color: new THREE.Color(color).getHex(), linewidth: 2.5 });
    const path = new Line2(line, material);
    path.frustumCulled = false;
    group.add(path);
    const controls = geometry.arrays.controls as Float32Array | undefined;
    if (!controls) {
        return drawable(group, line, material);
    }
    const corners = new THREE.BufferGeometry();
    corners.setAttribute("position", new THREE.BufferAttribute(controls, 3));
    const dots = discs(controlColor, 9, true);
    const points = new THREE.Points(corners, dots);
    points.frustumCulled = false;
    points.renderOrder = 2;
    group.add(points);
    return drawable(group, line, material, corners, dots);
}

/** The segments of a skeleton as lines in front of everything, and its nodes as dots. */
export function drawBones(geometry: Geometry, tree: Tree, color: THREE.ColorRepresentation): Drawable {
    const buffers = new THREE.BufferGeometry();
    buffers.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    const ends: number[] = [];
    tree.parent.forEach((p, n) => {
        if (p !== kNone) {
            ends.push(p, n);
        }
    });
    buffers.setIndex(ends);
    const material = new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.9 });
    const lines = new THREE.LineSegments(buffers, material);
    const dots = discs(color, 2.5, true);
    const points = new THREE.Points(buffers, dots);
    for (const object of [lines, points]) {
        object.frustumCulled = false;
        object.renderOrder = 2;
    }
    const group = new THREE.Group();
    group.position.set(...geometry.header.origin);
    group.add(lines, points);
    return drawable(group, buffers, material, dots);
}

/** The edges of the faces of a cage. */
export function drawCage(geometry: Geometry, lines: Uint32Array, color: THREE.ColorRepresentation): Drawable {
    const buffers = new THREE.BufferGeometry();
    buffers.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    buffers.setIndex(new THREE.BufferAttribute(lines, 1));
    const material = new THREE.LineBasicMaterial({ color });
    const cage = new THREE.LineSegments(buffers, material);
    cage.position.set(...geometry.header.origin);
    cage.frustumCulled = false;
    return drawable(cage, buffers, material);
}
