// Converts a stroke on the screen to points in space: the depth is that of the surrounding branches.
import type { Point } from "../../protocol";
import type { Skeleton } from "../kit/skeleton";
import { add, mix, scaled, simplified } from "../kit/vector";

export type Pixel = readonly [number, number];

const kReach = 80; // [px] maximum distance of a node that contributes its depth
const kStartWeight = 1; // of the start of the stroke; it decreases with the length of the stroke
const kStartReach = 160; // [px]
const kFloor = 0.02; // minimum weight of the start, where no node is close
const kMaxPoints = 40;
const kSmoothing = 3;

interface Camera {
    toPixels(point: Point): [number, number, number];
    toPlane(x: number, y: number, through: Point): Point | null;
}

/** The points in space for the pixels of a stroke; the first is `start`. */
export function depthsOf(stroke: readonly Pixel[], start: Point, skeleton: Skeleton | null, camera: Camera): Point[] {
    const near = skeleton ? skeleton.all().map((n) => ({ at: skeleton.at(n), pixel: camera.toPixels(skeleton.at(n)) })) : [];
    let gone = 0;
    const raw = stroke.map(([x, y], i) => {
        gone += i > 0 ? Math.hypot(x - stroke[i - 1][0], y - stroke[i - 1][1]) : 0;
        let weight = kFloor + kStartWeight * Math.exp(-((gone / kStartReach) ** 2));
        let sum = scaled(start, weight);
        for (const { at, pixel } of near) {
            const far = Math.hypot(pixel[0] - x, pixel[1] - y);
            if (far < 3 * kReach && Math.abs(pixel[2]) <= 1) {
                const w = Math.exp(-((far / kReach) ** 2)) / Math.max(near.length / 8, 1);
                weight += w;
                sum = add(sum, scaled(at, w));
            }
        }
        return scaled(sum, 1 / weight);
    });
    raw[0] = start;
    return smooth(raw);
}

function smooth(points: Point[]): Point[] {
    let now = points;
    for (let pass = 0; pass < kSmoothing; ++pass) {
        now = now.map((point, i) => (i === 0 || i + 1 === now.length ? point : mix(point, mix(now[i - 1], now[i + 1], 0.5), 0.5)));
    }
    return now;
}

/** The branch of a stroke; null if the stroke is too short. */
export function drawnBranch(stroke: readonly Pixel[], start: Point, skeleton: Skeleton | null, camera: Camera): Point[] | null {
    let off = 1;
    let line = simplified(stroke, off);
    for (; line.length > kMaxPoints; off *= 1.5) {
        line = simplified(stroke, off);
    }
    const length = line.reduce((sum, [x, y], i) => sum + (i > 0 ? Math.hypot(x - line[i - 1][0], y - line[i - 1][1]) : 0), 0);
    if (line.length < 2 || length < 8) {
        return null;
    }
    const depths = depthsOf(line, start, skeleton, camera);
    const points = line.map(([x, y], i) => (i === 0 ? start : camera.toPlane(x, y, depths[i])));
    return points.every((point): point is Point => point !== null) ? points : null;
}
