// Points and directions, and intersections with lines of sight.
import type { Ray } from "../../app";
import type { Point } from "../../protocol";

export const kAxes: Record<"x" | "y" | "z", Point> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

export const add = (a: Point, b: Point): Point => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a: Point, by: number): Point => [a[0] * by, a[1] * by, a[2] * by];
export const dot = (a: Point, b: Point): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Point): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Point, b: Point): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
export const mix = (a: Point, b: Point, share: number): Point => add(scaled(a, 1 - share), scaled(b, share));
export const along = (ray: Ray, far: number): Point => add(ray.origin, scaled(ray.direction, far));

export function cross(a: Point, b: Point): Point {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** Unit vector; `otherwise` for the zero vector. */
export function normalized(a: Point, otherwise: Point = [0, 0, 1]): Point {
    const size = length(a);
    return size > 1e-12 ? scaled(a, 1 / size) : otherwise;
}

/** The component of `a` perpendicular to `direction`, a unit vector. */
export function across(a: Point, direction: Point): Point {
    return subtract(a, scaled(direction, dot(a, direction)));
}

/** `a` rotated about a unit axis, counter-clockwise seen against it. */
export function rotated(a: Point, axis: Point, angle: number): Point {
    const part = scaled(axis, dot(a, axis) * (1 - Math.cos(angle)));
    return add(add(scaled(a, Math.cos(angle)), scaled(cross(axis, a), Math.sin(angle))), part);
}

export function angleBetween(a: Point, b: Point): number {
    return Math.atan2(length(cross(a, b)), dot(a, b));
}

/** The angle from a to b about an axis, in (-pi, pi]. */
export function angleAbout(a: Point, b: Point, axis: Point): number {
    const [from, to] = [across(a, axis), across(b, axis)];
    return Math.atan2(dot(cross(from, to), axis), dot(from, to));
}

/** Any unit vector perpendicular to a unit vector. */
export function perpendicular(axis: Point): Point {
    return normalized(cross(axis, Math.abs(axis[2]) < 0.9 ? kAxes.z : kAxes.x));
}

/** The intersection of a ray and a plane; null if the ray is parallel to the plane or points away from it. */
export function onPlane(ray: Ray, through: Point, normal: Point): Point | null {
    const slope = dot(ray.direction, normal);
    if (Math.abs(slope) < 1e-6 * length(normal)) {
        return null;
    }
    const far = dot(subtract(through, ray.origin), normal) / slope;
    return far > 0 ? along(ray, far) : null;
}

/** The position along a line with a unit direction that is closest to the ray; null if they are parallel. */
export function onLine(ray: Ray, through: Point, direction: Point): number | null {
    const slope = dot(ray.direction, direction);
    const least = 1 - slope * slope;
    if (least < 1e-8) {
        return null;
    }
    const between = subtract(ray.origin, through);
    return (dot(between, direction) - slope * dot(between, ray.direction)) / least;
}

/** Distance in pixels from a position to a segment in the view, and the parameter on it, in [0, 1]. */
export function toSegment(x: number, y: number, a: readonly number[], b: readonly number[]): { far: number; share: number } {
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const size = dx * dx + dy * dy;
    const share = size > 0 ? Math.min(Math.max(((x - a[0]) * dx + (y - a[1]) * dy) / size, 0), 1) : 0;
    return { far: Math.hypot(x - a[0] - share * dx, y - a[1] - share * dy), share };
}

/** Simplifies a polyline within a distance of `most` (Douglas and Peucker). */
export function simplified<T extends readonly number[]>(line: readonly T[], most: number): T[] {
    const keep = new Set([0, line.length - 1]);
    const ranges: [number, number][] = [[0, line.length - 1]];
    for (let range = ranges.pop(); range; range = ranges.pop()) {
        const [first, last] = range;
        let [worst, far] = [-1, most];
        for (let i = first + 1; i < last; ++i) {
            const { far: off } = toSegment(line[i][0], line[i][1], line[first], line[last]);
            if (off > far) {
                [worst, far] = [i, off];
            }
        }
        if (worst > 0) {
            keep.add(worst);
            ranges.push([first, worst], [worst, last]);
        }
    }
    return line.filter((_, i) => keep.has(i));
}

/** The smallest number of the form 1, 2 or 5 times a power of ten that is not below `least`. */
export function roundStep(least: number): number {
    const power = 10 ** Math.floor(Math.log10(least));
    const part = least / power;
    return power * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10);
}

export const snapped = (value: number, step: number): number => (step > 0 ? Math.round(value / step) * step : value);
