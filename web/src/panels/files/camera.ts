// The camera and the sun of the view in the form of the path tracer.
import type * as THREE from "three";
import type { Point } from "../../protocol";
import { sunAt } from "../../view/stage";

export interface Eye {
    eye: Point;
    target: Point;
    up: Point;
    field_of_view?: number; // [degree] vertical
    parallel?: number; // [m] vertical size of a parallel view
}

/** Position and parameters of a camera; both kinds look along their own -Z. */
export function eyeOf(camera: THREE.Camera): Eye {
    const m = camera.matrixWorld.elements;
    const eye: Point = [m[12], m[13], m[14]];
    const up: Point = [m[4], m[5], m[6]];
    const target: Point = [m[12] - m[8], m[13] - m[9], m[14] - m[10]];
    if ("isOrthographicCamera" in camera) {
        const { top, bottom } = camera as THREE.OrthographicCamera;
        return { eye, target, up, parallel: top - bottom };
    }
    return { eye, target, up, field_of_view: (camera as THREE.PerspectiveCamera).fov };
}

const kLowestSun = 2.87; // [degree] minimum that `render` accepts

/** Options of `render`: its angles are counter-clockwise from +X, those of the view clockwise from +Y. */
export function sunOptions(hour: number, north: number): Record<string, number> {
    const { height, azimuth } = sunAt(hour, north);
    return { azimuth: 0, sun_azimuth: 90 - azimuth, sun_elevation: Math.max(height, kLowestSun) };
}
