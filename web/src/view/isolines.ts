// Isolines of a sampled field.
import { ticks } from "./lengths";

export interface Samples {
    value: Float32Array; // rows from the corner
    width: number;
    height: number;
}

/** End points of the segments on which the field has a value; both coordinates in [0, 1], from the corner. */
export function isolines({ value, width, height }: Samples, level: number): number[] {
    const ends: number[] = [];
    const cut = (ax: number, ay: number, a: number, bx: number, by: number, b: number) => {
        const t = (level - a) / (b - a);
        ends.push((ax + (bx - ax) * t) / (width - 1), (ay + (by - ay) * t) / (height - 1));
    };
    for (let y = 0; y + 1 < height; ++y) {
        for (let x = 0; x + 1 < width; ++x) {
            const corners = [
                [x, y],
                [x + 1, y],
                [x + 1, y + 1],
                [x, y + 1],
            ];
            const values = corners.map(([cx, cy]) => value[cy * width + cx]);
            const sides = [0, 1, 2, 3].filter((k) => values[k] > level !== values[(k + 1) % 4] > level);
            if (sides.length === 0) {
                continue;
            }
            // If two opposite corners are above the value, the centre decides whether they are connected.
            const middle = (values[0] + values[1] + values[2] + values[3]) / 4 > level;
            const ordered = sides.length === 4 && middle === values[0] > level ? [0, 1, 2, 3] : sides.length === 4 ? [3, 0, 1, 2] : sides;
            for (const k of ordered) {
                const [a, b] = [corners[k], corners[(k + 1) % 4]];
                cut(a[0], a[1], values[k], b[0], b[1], values[(k + 1) % 4]);
            }
        }
    }
    return ends;
}

/** Round values between minimum and maximum, without the value of the surface, which has its own line. */
export function isoLevels(low: number, high: number, level: number, count: number): number[] {
    return count < 1 ? [] : ticks(low, high, count).filter((value) => value > low && value < high && Math.abs(value - level) > 1e-9);
}
