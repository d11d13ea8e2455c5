// Finds the object at a point of the view.
import * as THREE from "three";
import type { Pick } from "../../app";
import type { Kind, Point } from "../../protocol";
import type { Rig } from "../camera/rig";
import { treeOf } from "../extent";
import type { SectionPlane } from "../section";
import type { ObjectView } from "../object_view";
import { closestSegment, hitLine, hitPoints, hitSkeleton, type Projection } from "./rays";

const kTwig = 3.5; // [px] minimum thickness of a segment for picking
const kPoint = 7;
const kControl = 11;
const kLine = 6;

export interface Picture {
    rig: Rig;
    section: SectionPlane;
    width: number;
    height: number;
    glass: boolean; // solids are transparent, and objects inside can be picked
}

interface Found {
    distance: number; // [m] from the camera
    pick: Pick;
}

const kPickable: Kind[] = ["skeleton", "solid", "mesh", "points", "path", "profile"];

// Drawn through transparent solids, and preferred to them for picking. Points are too numerous for that.
const kThroughGlass: Kind[] = ["skeleton", "mesh", "path", "profile"];

/** The object closest to the camera; objects inside transparent solids have priority over the solids. */
export function pickAt(picture: Picture, ray: THREE.Ray, shown: ObjectView[], x: number, y: number, kinds: Kind[] = kPickable): Pick | null {
    const found = shown
        .filter(({ object, source }) => kinds.includes(object.kind) || (source && kinds.includes("skeleton")))
        .map((one) => {
            const hit = pickOne(picture, ray, one, x, y);
            return hit && one.source && kinds.includes("skeleton") ? onSource(hit, one.source) : hit;
        })
        .filter((one) => one !== null)
        .sort((a, b) => a.distance - b.distance);
    const inside = picture.glass ? found.find(({ pick }) => kThroughGlass.includes(pick.object.kind)) : undefined;
    return (inside ?? found[0])?.pick ?? null;
}

function pickOne(picture: Picture, ray: THREE.Ray, shown: ObjectView, x: number, y: number): Found | null {
    switch (shown.object.kind) {
        case "skeleton":
            return pickSkeleton(picture, ray, shown);
        case "solid":
        case "mesh":
            return pickSurface(picture, ray, shown);
        case "points":
            return pickDots(picture, shown, x, y, "points", kPoint);
        default:
            return pickDots(picture, shown, x, y, "curve", kControl) ?? pickCurve(picture, shown, x, y);
    }
}

function pickSkeleton({ rig, section }: Picture, ray: THREE.Ray, shown: ObjectView): Found | null {
    const geometry = shown.geometries.get("axes");
    if (!geometry) {
        return null;
    }
    const tree = treeOf(geometry);
    const from = ray.origin
        .clone()
        .sub(new THREE.Vector3(...geometry.header.origin))
        .toArray();
    const cosine = ray.direction.dot(rig.forward());
    const at = new THREE.Vector3();
    const hit = hitSkeleton(
        tree,
        geometry.arrays.position as Float32Array,
        from,
        ray.direction.toArray(),
        (distance) => kTwig * rig.pixelSize(distance * cosine),
        (distance) => !section.hides(ray.at(distance, at)),
    );
    if (!hit) {
        return null;
    }
    const point = ray.at(hit.distance, at).toArray();
    return { distance: hit.distance, pick: { object: shown.object, point, node: tree.id[hit.node] } };
}

function pickSurface({ section }: Picture, ray: THREE.Ray, shown: ObjectView): Found | null {
    if (!shown.surface?.group.visible) {
        return null;
    }
    const from = ray.origin.clone().sub(shown.surface.group.position).toArray();
    const at = new THREE.Vector3();
    const distance = shown.surface.triangleTree().hit(from, ray.direction.toArray(), (far) => !section.hides(ray.at(far, at)));
    return distance === null ? null : { distance, pick: { object: shown.object, point: ray.at(distance, at).toArray() } };
}

/** Converts a hit on a mesh to the branch of its source skeleton. */
function onSource(hit: Found, source: ObjectView): Found {
    const geometry = source.geometries.get("axes");
    if (!geometry) {
        return hit;
    }
    const { point } = hit.pick;
    const tree = treeOf(geometry);
    const local = point.map((value, i) => value - geometry.header.origin[i]) as Point;
    const node = tree.id[closestSegment(tree, geometry.arrays.position as Float32Array, local)];
    return { ...hit, pick: { object: source.object, point, node } };
}

function projection({ rig, width, height }: Picture, origin: Point): Projection {
    const camera = rig.camera;
    const matrix = new THREE.Matrix4()
        .makeTranslation(...origin)
        .premultiply(camera.matrixWorldInverse)
        .premultiply(camera.projectionMatrix);
    return { matrix: matrix.elements, width, height };
}

function pickDots(picture: Picture, shown: ObjectView, x: number, y: number, slot: "points" | "curve", reach: number): Found | null {
    const geometry = shown.geometries.get(slot);
    const position = geometry?.arrays[slot === "points" ? "position" : "controls"] as Float32Array | undefined;
    if (!geometry || !position) {
        return null;
    }
    const index = hitPoints(position, projection(picture, geometry.header.origin), x, y, reach);
    return index === null ? null : found(picture, shown, pointOf(position, index, geometry.header.origin), index);
}

function pickCurve(picture: Picture, shown: ObjectView, x: number, y: number): Found | null {
    const geometry = shown.geometries.get("curve");
    if (!geometry) {
        return null;
    }
    const position = geometry.arrays.position as Float32Array;
    const { origin, closed } = geometry.header;
    const at = hitLine(position, closed ?? false, projection(picture, origin), x, y, kLine);
    return at === null ? null : found(picture, shown, pointOf(position, at, origin));
}

function pointOf(position: Float32Array, index: number, origin: Point): Point {
    return [0, 1, 2].map((c) => position[3 * index + c] + origin[c]) as Point;
}

function found({ rig }: Picture, shown: ObjectView, point: Point, index?: number): Found {
    const distance = new THREE.Vector3(...point).distanceTo(rig.pose.eye);
    return { distance, pick: index === undefined ? { object: shown.object, point } : { object: shown.object, point, index } };
}
