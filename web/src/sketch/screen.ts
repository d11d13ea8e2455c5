// An image in its pane: zoom, pan and hit tests.
import { type Pixel, type Stroke, widthAt } from "./model";

/** The position of the upper left corner of the image in the pane, and the size of its pixels. */
export interface Screen {
    scale: number;
    x: number;
    y: number;
}

export const toScreen = ({ scale, x, y }: Screen, [px, py]: Pixel): Pixel => [x + px * scale, y + py * scale];
export const toPicture = ({ scale, x, y }: Screen, sx: number, sy: number): Pixel => [(sx - x) / scale, (sy - y) / scale];

export function zoomedAt(screen: Screen, sx: number, sy: number, factor: number): Screen {
    const scale = Math.min(Math.max(screen.scale * factor, 0.01), 50);
    const by = scale / screen.scale;
    return { scale, x: sx + (screen.x - sx) * by, y: sy + (screen.y - sy) * by };
}

export function fitted(width: number, height: number, paneWidth: number, paneHeight: number): Screen {
    const scale = Math.min(paneWidth / width, paneHeight / height);
    return { scale, x: (paneWidth - width * scale) / 2, y: (paneHeight - height * scale) / 2 };
}

/** Unit vector across a stroke at a point. */
export function acrossAt(points: readonly Pixel[], i: number): Pixel {
    const a = points[Math.max(i - 1, 0)];
    const b = points[Math.min(i + 1, points.length - 1)];
    const size = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    return [-(b[1] - a[1]) / size, (b[0] - a[0]) / size];
}

/** Both edges of a stroke at a point, in pixels of the image. */
export function edgesAt(stroke: Stroke, i: number): [Pixel, Pixel] {
    const [nx, ny] = acrossAt(stroke.points, i);
    const [x, y] = stroke.points[i];
    const half = widthAt(stroke, i) / 2;
    return [
        [x + nx * half, y + ny * half],
        [x - nx * half, y - ny * half],
    ];
}

export type Grip = { part: "point" | "edge"; index: number };

/** The element of a stroke under the pointer: a point, or an edge at a point. */
export function gripAt(stroke: Stroke, screen: Screen, sx: number, sy: number, most: number): Grip | null {
    let best: (Grip & { far: number }) | null = null;
    const offer = (part: Grip["part"], index: number, at: Pixel, penalty: number) => {
        const [x, y] = toScreen(screen, at);
        const far = Math.hypot(x - sx, y - sy) + penalty;
        if (far <= (best?.far ?? most)) {
            best = { part, index, far };
        }
    };
    stroke.points.forEach((point, i) => {
        offer("point", i, point, 0);
        edgesAt(stroke, i).forEach((edge) => offer("edge", i, edge, 2)); // for thin strokes the point has priority
    });
    return best;
}

/** The width after a drag of an edge: twice the distance of the pointer from the axis. */
export function widthByEdge(stroke: Stroke, i: number, at: Pixel): number {
    const [nx, ny] = acrossAt(stroke.points, i);
    const [x, y] = stroke.points[i];
    return 2 * Math.abs((at[0] - x) * nx + (at[1] - y) * ny);
}
