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
export interface Drawn {
    object: THREE.Object3D;
    dispose(): void;
}

function drawn(object: THREE.Object3D, ...parts: { dispose(): void }[]): Drawn {
    return { object, dispose: () => parts.forEach((part) => part.dispose()) };
}

export function drawPoints(geometry: Geometry, color: THREE.ColorRepresentation, size: number): Drawn {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    const colors = geometry.arrays.color as Uint8Array | undefined;
    const material = discs(colors ? "white" : color, size);
    if (colors) {
        made.setAttribute("color", new THREE.BufferAttribute(colors, 4, true));
        material.vertexColors = true;
    }
    const points = new THREE.Points(made, material);
    points.position.set(...geometry.header.origin);
    points.frustumCulled = false;
    return drawn(points, made, material);
}

export function drawCurve(geometry: Geometry, color: THREE.ColorRepresentation, controlColor: THREE.ColorRepresentation): Drawn {
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
        return drawn(group, line, material);
    }
    const corners = new THREE.BufferGeometry();
    corners.setAttribute("position", new THREE.BufferAttribute(controls, 3));
    const dots = discs(controlColor, 9, true);
    const points = new THREE.Points(corners, dots);
    points.frustumCulled = false;
    points.renderOrder = 2;
    group.add(points);
    return drawn(group, line, material, corners, dots);
}

/** The segments of a skeleton as lines in front of everything, and its nodes as dots. */
export function drawBones(geometry: Geometry, tree: Tree, color: THREE.ColorRepresentation): Drawn {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    const ends: number[] = [];
    tree.parent.forEach((p, n) => {
        if (p !== kNone) {
            ends.push(p, n);
        }
    });
    made.setIndex(ends);
    const material = new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.9 });
    const lines = new THREE.LineSegments(made, material);
    const dots = discs(color, 2.5, true);
    const points = new THREE.Points(made, dots);
    for (const object of [lines, points]) {
        object.frustumCulled = false;
        object.renderOrder = 2;
    }
    const group = new THREE.Group();
    group.position.set(...geometry.header.origin);
    group.add(lines, points);
    return drawn(group, made, material, dots);
}

/** The edges of the faces of a cage. */
export function drawCage(geometry: Geometry, lines: Uint32Array, color: THREE.ColorRepresentation): Drawn {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(geometry.arrays.position as Float32Array, 3));
    made.setIndex(new THREE.BufferAttribute(lines, 1));
    const material = new THREE.LineBasicMaterial({ color });
    const cage = new THREE.LineSegments(made, material);
    cage.position.set(...geometry.header.origin);
    cage.frustumCulled = false;
    return drawn(cage, made, material);
}
