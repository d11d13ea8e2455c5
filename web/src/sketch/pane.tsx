// One view of the sketch: strokes are drawn and edited over its image.
import { effect, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import {
    addStroke,
    branchAt,
    changeStroke,
    drawnStroke,
    insertPoint,
    isComplete,
    movePoint,
    type Pixel,
    removePoint,
    setWidth,
    type SketchView,
    type Stroke,
    widthAt,
} from "./model";
import { paint } from "./paint";
import { fitted, gripAt, type Grip, type Screen, toPicture, widthByEdge, zoomedAt } from "./screen";
import type { SketchWork } from "./work";

const kNear = 10; // [px] of the screen
const kFirstStep = 10; // [px] step of an arrow key
const kThin = 0.7; // [px of the screen] tolerance of the simplified stroke

type Doing = "nothing" | "draw" | "grip" | "pan";

/** Input in one pane by mouse, pen, touch and keys. */
class PaneHand {
    readonly screen = signal<Screen>({ scale: 1, x: 0, y: 0 });
    readonly drawing = signal<Stroke | null>(null);
    readonly cursor = signal<Pixel | null>(null);
    private doing: Doing = "nothing";
    private grip: Grip | null = null;
    private isMoved = false; // the dragged element
    private line: Pixel[] = [];
    private widths: number[] = [];
    private last: Pixel = [0, 0];
    private readonly fingers = new Map<number, Pixel>();

    constructor(
        private readonly work: SketchWork,
        readonly view: () => SketchView,
        private readonly canvas: () => HTMLCanvasElement,
    ) {}

    down(event: PointerEvent): void {
        const at: Pixel = [event.offsetX, event.offsetY];
        this.canvas().setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, at);
        this.last = at;
        this.cursor.value = null;
        if (this.fingers.size > 1 || event.button !== 0 || event.altKey) {
            this.drawing.value = null;
            this.doing = "pan";
            return;
        }
        const held = this.held();
        const grip = held && gripAt(held, this.screen.peek(), at[0], at[1], kNear);
        if (grip) {
            this.doing = "grip";
            this.grip = grip;
            this.isMoved = false;
            this.work.point.value = grip.index;
            return;
        }
        this.doing = "draw";
        this.line = [this.picture(at)];
        this.widths = [this.penWidth(event)];
    }

    move(event: PointerEvent): void {
        const at: Pixel = [event.offsetX, event.offsetY];
        if (this.fingers.has(event.pointerId)) {
            this.pan(event.pointerId, at);
        }
        this.work.lookAlong(this.view(), this.picture(at));
        if (this.doing === "draw") {
            this.extend(event, at);
        } else if (this.doing === "grip") {
            this.drag(this.picture(at));
        }
    }

    up(event: PointerEvent): void {
        this.fingers.delete(event.pointerId);
        if (this.doing === "draw" && event.type !== "pointercancel") {
            this.finish();
        } else if (this.isMoved) {
            void this.work.rebuild();
        }
        if (this.fingers.size === 0) {
            this.doing = "nothing";
            this.grip = null;
            this.isMoved = false;
            this.drawing.value = null;
        }
    }

    wheel(event: WheelEvent): void {
        event.preventDefault();
        if (event.ctrlKey || this.doing === "draw") {
            this.work.width.value = Math.min(Math.max(this.work.width.peek() * Math.exp(-event.deltaY / 800), 0.5), 2000);
        } else {
            this.screen.value = zoomedAt(this.screen.peek(), event.offsetX, event.offsetY, Math.exp(-event.deltaY / 800));
        }
    }

    /** Inserts a point at the position of a double click. */
    twice(event: MouseEvent): void {
        const at = this.picture([event.offsetX, event.offsetY]);
        const { name } = this.view();
        const under = branchAt(this.work.sketch.peek(), name, at, kNear / this.screen.peek().scale);
        if (under) {
            this.work.chosen.value = under.name;
            this.work.point.value = under.piece;
            this.work.set(changeStroke(this.work.sketch.peek(), under.name, name, (stroke) => insertPoint(stroke, under.piece, at)));
            void this.work.rebuild();
        }
    }

    key(event: KeyboardEvent): void {
        if (this.cursorKey(event) || this.editKey(event)) {
            event.preventDefault();
            event.stopPropagation();
        }
    }

    /** Keyboard operation: arrows move a cross, the space bar adds a point of a stroke at its position, Enter ends the stroke. */
    private cursorKey(event: KeyboardEvent): boolean {
        const far = kFirstStep * (event.shiftKey ? 0.1 : 1) * (event.altKey ? 10 : 1);
        const steps: Record<string, Pixel> = {
            ArrowLeft: [-far, 0],
            ArrowRight: [far, 0],
            ArrowUp: [0, -far],
            ArrowDown: [0, far],
        };
        const step = steps[event.key];
        const { width = 800, height = 800 } = this.view();
        const at = this.cursor.peek() ?? [Math.round(width / 2), Math.round(height / 2)];
        if (step) {
            this.cursor.value = this.cursor.peek() ? [at[0] + step[0], at[1] + step[1]] : at;
            this.work.lookAlong(this.view(), this.cursor.value ?? at);
            return true;
        }
        if (event.key === " ") {
            this.line = this.drawing.peek() ? [...this.line, at] : [at];
            this.widths = this.drawing.peek() ? [...this.widths, this.work.width.peek()] : [this.work.width.peek()];
            this.cursor.value = at;
            this.drawing.value = { points: this.line, widths: this.widths };
            return true;
        }
        if (event.key === "+" || event.key === "-") {
            this.work.width.value = Math.max(this.work.width.peek() * (event.key === "+" ? 1.2 : 1 / 1.2), 0.5);
            return true;
        }
        if (event.key === "Enter" && this.drawing.peek()) {
            this.finish();
            return true;
        }
        if (event.key === "Escape" && (this.drawing.peek() || this.cursor.peek() || this.work.chosen.peek())) {
            this.work.chosen.value = this.drawing.peek() || this.cursor.peek() ? this.work.chosen.peek() : null;
            this.drawing.value = null;
            this.cursor.value = null;
            return true;
        }
        return false;
    }

    private editKey(event: KeyboardEvent): boolean {
        const { work } = this;
        if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
            if (event.shiftKey) {
                work.redo();
            } else {
                work.undo();
            }
            return true;
        }
        const name = work.chosen.peek();
        if ((event.key === "Delete" || event.key === "Backspace") && name) {
            const point = work.point.peek();
            work.set(changeStroke(work.sketch.peek(), name, this.view().name, (stroke) => (point >= 0 ? removePoint(stroke, point) : null)));
            work.point.value = -1;
            void work.rebuild();
            return true;
        }
        return false;
    }

    private picture(at: Pixel): Pixel {
        return toPicture(this.screen.peek(), at[0], at[1]);
    }

    private held(): Stroke | undefined {
        const name = this.work.chosen.peek();
        return this.work.sketch.peek().branches.find((branch) => branch.name === name)?.strokes[this.view().name];
    }

    // A pen reports pressure; a mouse always reports half.
    private penWidth(event: PointerEvent): number {
        const pressed = event.pointerType === "pen" && event.pressure > 0 ? 2 * event.pressure : 1;
        return this.work.width.peek() * pressed;
    }

    private pan(id: number, at: Pixel): void {
        if (this.doing === "pan") {
            const screen = this.screen.peek();
            const before = this.fingers.get(id) ?? at;
            const others = [...this.fingers].filter(([other]) => other !== id).map(([, place]) => place);
            const share = others.length > 0 ? 0.5 : 1;
            const moved = { ...screen, x: screen.x + (at[0] - before[0]) * share, y: screen.y + (at[1] - before[1]) * share };
            if (others.length > 0) {
                const [other] = others;
                const far = (place: Pixel) => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
                this.screen.value = zoomedAt(moved, (at[0] + other[0]) / 2, (at[1] + other[1]) / 2, far(at) / far(before));
            } else {
                this.screen.value = moved;
            }
        }
        this.fingers.set(id, at);
    }

    private extend(event: PointerEvent, at: Pixel): void {
        if (Math.hypot(at[0] - this.last[0], at[1] - this.last[1]) >= 2) {
            this.last = at;
            this.line.push(this.picture(at));
            this.widths.push(this.penWidth(event));
            this.drawing.value = { points: [...this.line], widths: [...this.widths] };
        }
    }

    private drag(at: Pixel): void {
        const name = this.work.chosen.peek();
        const { grip } = this;
        if (name && grip) {
            const change = (stroke: Stroke) =>
                grip.part === "point" ? movePoint(stroke, grip.index, at) : setWidth(stroke, grip.index, widthByEdge(stroke, grip.index, at));
            this.work.set(changeStroke(this.work.sketch.peek(), name, this.view().name, change), !this.isMoved);
            this.isMoved = true;
        }
    }

    private finish(): void {
        const stroke = drawnStroke(this.line, this.widths, kThin / this.screen.peek().scale);
        this.drawing.value = null;
        if (!stroke) {
            this.choose(this.line[0]); // a click
            return;
        }
        const { sketch, name } = addStroke(this.work.sketch.peek(), this.view().name, tapered(stroke), this.work.chosen.peek());
        this.work.set(sketch);
        // A branch that all views show is deselected: otherwise the start of the next stroke could grab one of its points.
        this.work.chosen.value = isComplete(sketch, name) ? null : name;
        this.work.point.value = -1;
        void this.work.rebuild();
    }

    private choose(at: Pixel): void {
        const under = branchAt(this.work.sketch.peek(), this.view().name, at, kNear / this.screen.peek().scale);
        if (under) {
            this.work.chosen.value = under.name;
            this.work.point.value = -1;
        }
    }
}

/** A stroke of constant width, drawn with a mouse, is tapered to half the width at its tip; the widths of a pen are kept. */
export function tapered(stroke: Stroke): Stroke {
    const first = widthAt(stroke, 0);
    const even = stroke.points.every((_, i) => Math.abs(widthAt(stroke, i) - first) < 0.01 * first);
    return even ? { ...stroke, widths: [first, first / 2] } : stroke;
}

export function Pane({ work, index }: { work: SketchWork; index: number }): VNode {
    const canvas = useRef<HTMLCanvasElement>(null);
    const hand = useRef<PaneHand | null>(null);
    hand.current ??= new PaneHand(
        work,
        () => work.sketch.peek().views[index] ?? work.sketch.peek().views[0],
        () => canvas.current as HTMLCanvasElement,
    );
    const own = hand.current;
    // Not useEffect: its clean-up would run after the images were closed.
    useLayoutEffect(() => {
        const element = canvas.current;
        const context = element?.getContext("2d");
        if (!element || !context) {
            return undefined;
        }
        let fittedTo = "";
        const draw = () => {
            const sketch = work.sketch.value;
            const view = sketch.views[index];
            if (!view) {
                return;
            }
            const picture = (view.image && work.pictures.value.get(view.image)) || null;
            const size = [view.width ?? picture?.width ?? 800, view.height ?? picture?.height ?? 800] as const;
            const key = `${size.join(" ")} ${element.clientWidth} ${element.clientHeight}`;
            if (key !== fittedTo && element.clientWidth > 0) {
                fittedTo = key;
                own.screen.value = fitted(size[0], size[1], element.clientWidth, element.clientHeight);
            }
            const line = work.line.value;
            paint(context, {
                sketch,
                view,
                picture,
                screen: own.screen.value,
                chosen: work.chosen.value,
                point: work.point.value,
                refused: new Set(work.fits.value.filter(({ refused }) => refused).map(({ name }) => name)),
                line: line?.view === view.name ? line.points : [],
                drawing: own.drawing.value,
                cursor: own.cursor.value,
            });
        };
        const stop = effect(draw);
        const resize = new ResizeObserver(() => {
            element.width = Math.round(element.clientWidth * devicePixelRatio);
            element.height = Math.round(element.clientHeight * devicePixelRatio);
            draw();
        });
        resize.observe(element);
        const wheel = (event: WheelEvent) => own.wheel(event);
        element.addEventListener("wheel", wheel, { passive: false });
        return () => {
            stop();
            resize.disconnect();
            element.removeEventListener("wheel", wheel);
        };
    }, [index]);
    return (
        <canvas
            ref={canvas}
            class="sketch-canvas"
            tabIndex={0}
            role="application"
            aria-label={`View ${own.view().name}: arrows move a cross, the space bar adds a point, Enter ends the stroke`}
            onPointerDown={(event) => own.down(event)}
            onPointerMove={(event) => own.move(event)}
            onPointerUp={(event) => own.up(event)}
            onPointerCancel={(event) => own.up(event)}
            onPointerLeave={() => work.lookAway()}
            onDblClick={(event) => own.twice(event)}
            onKeyDown={(event) => own.key(event)}
            onContextMenu={(event) => event.preventDefault()}
        />
    );
}
