// Draws one view of a sketch.
import type { Pixel, Sketch, SketchView, Stroke } from "./model";
import { widthAt } from "./model";
import { edgesAt, type Screen, toScreen } from "./screen";

export interface Painted {
    sketch: Sketch;
    view: SketchView;
    screen: Screen;
    picture: ImageBitmap | null;
    chosen: string | null;
    point: number; // index in the chosen stroke
    refused: ReadonlySet<string>;
    line: readonly Pixel[]; // epipolar line of the pointer position in another view
    drawing: Stroke | null;
    cursor: Pixel | null; // position of the keyboard cursor
}

const kColors = { stroke: "#2f9e5b", chosen: "#ffb000", refused: "#e5484d", line: "#2f81f7", cursor: "#d6409f" };

function path(context: CanvasRenderingContext2D, screen: Screen, points: readonly Pixel[], closed = false): void {
    context.beginPath();
    points.forEach((point, i) => {
        const [x, y] = toScreen(screen, point);
        if (i === 0) {
            context.moveTo(x, y);
        } else {
            context.lineTo(x, y);
        }
    });
    if (closed) {
        context.closePath();
    }
}

function paintStroke(context: CanvasRenderingContext2D, screen: Screen, stroke: Stroke, color: string): void {
    const edges = stroke.points.map((_, i) => edgesAt(stroke, i));
    context.globalAlpha = 0.3;
    context.fillStyle = color;
    path(context, screen, [...edges.map(([left]) => left), ...edges.map(([, right]) => right).reverse()], true);
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = color;
    context.lineWidth = 2;
    path(context, screen, stroke.points);
    context.stroke();
}

function paintGrips(context: CanvasRenderingContext2D, screen: Screen, stroke: Stroke, point: number): void {
    stroke.points.forEach((at, i) => {
        const [x, y] = toScreen(screen, at);
        context.fillStyle = i === point ? "#ffffff" : kColors.chosen;
        context.strokeStyle = "#000000";
        context.lineWidth = 1;
        context.beginPath();
        context.arc(x, y, i === 0 ? 6 : 4, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
        if (widthAt(stroke, i) * screen.scale > 12) {
            for (const edge of edgesAt(stroke, i)) {
                const [ex, ey] = toScreen(screen, edge);
                context.fillRect(ex - 2.5, ey - 2.5, 5, 5);
            }
        }
    });
}

function paintGround(context: CanvasRenderingContext2D, { view, screen, picture }: Painted): void {
    const { width, height } = context.canvas;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    const [x, y] = toScreen(screen, [0, 0]);
    const size: Pixel = [view.width ?? picture?.width ?? 800, view.height ?? picture?.height ?? 800];
    if (picture) {
        context.drawImage(picture, x, y, picture.width * screen.scale, picture.height * screen.scale);
    } else {
        context.fillStyle = "#fdfdfb";
        context.fillRect(x, y, size[0] * screen.scale, size[1] * screen.scale);
    }
    if (view.origin) {
        const [ox, oy] = toScreen(screen, view.origin);
        context.strokeStyle = "#8a8f98";
        context.lineWidth = 1;
        context.beginPath();
        context.moveTo(x, oy);
        context.lineTo(x + size[0] * screen.scale, oy);
        context.moveTo(ox, oy - 8);
        context.lineTo(ox, oy + 8);
        context.stroke();
    }
}

export function paint(context: CanvasRenderingContext2D, painted: Painted): void {
    const { sketch, view, screen, chosen, refused, line, drawing, cursor } = painted;
    paintGround(context, painted);
    for (const { name, strokes } of sketch.branches) {
        const stroke = strokes[view.name];
        if (stroke) {
            paintStroke(context, screen, stroke, name === chosen ? kColors.chosen : refused.has(name) ? kColors.refused : kColors.stroke);
        }
    }
    const held = sketch.branches.find(({ name }) => name === chosen)?.strokes[view.name];
    if (held) {
        paintGrips(context, screen, held, painted.point);
    }
    if (drawing && drawing.points.length > 1) {
        paintStroke(context, screen, drawing, kColors.chosen);
    }
    if (line.length > 1) {
        context.strokeStyle = kColors.line;
        context.lineWidth = 1.5;
        context.setLineDash([6, 4]);
        path(context, screen, line);
        context.stroke();
        context.setLineDash([]);
    }
    if (cursor) {
        const [x, y] = toScreen(screen, cursor);
        context.strokeStyle = kColors.cursor;
        context.lineWidth = 1.5;
        context.beginPath();
        context.moveTo(x - 10, y);
        context.lineTo(x + 10, y);
        context.moveTo(x, y - 10);
        context.lineTo(x, y + 10);
        context.stroke();
    }
}
