// Curves through control points in space: new ones are drawn point by point, and existing ones are edited.
import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Overlay, kColors } from "../kit/overlay";
import { Button, CheckField, ChoiceField, TextField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { type Controls, findControls, replaceStatement } from "../kit/source";
import { TypedInput, typedShift } from "../kit/typed_input";
import { add, onPlane, subtract, toSegment } from "../kit/vector";
import { commandLine, pointWord } from "../kit/words";

const kCommands = ["path", "polyline", "spline", "polygon"] as const;
type CurveCommand = (typeof kCommands)[number];
const kChoices: readonly (readonly [CurveCommand, string])[] = [
    ["path", "Path"],
    ["polyline", "Straight solid"],
    ["spline", "Smooth solid"],
    ["polygon", "Flat solid"],
];
const kNear = 12; // [px]
const kNudge = 10; // [px]

const command: Signal<CurveCommand> = signal("path");

/** The statement of a curve with these control points and its existing options. */
export function curveLine(
    name: string,
    { command: word, options, comment }: Pick<Controls, "command" | "options" | "comment">,
    points: readonly (readonly number[])[],
    step: number,
): string {
    const line = commandLine([word, name, ...points.map((point) => pointWord(point, step))], options);
    return comment ? `${line} ${comment}` : line;
}

class CurveRun implements ToolRun {
    private points: Point[] = [];
    private readonly edited: Signal<Controls | null> = signal(null); // the edited statement; null: a new curve
    private object: ObjectName | null = null;
    private readonly count = signal(0); // number of points, for the status line
    private active = -1;
    private readonly writes = signal(0); // pending changes, which are not yet in the document
    private dragging = false;
    private from: Point | null = null;
    private moved = false;
    private gesture: Gesture | null = null;
    private readonly typed = new TypedInput();
    private readonly overlay: Overlay;
    private readonly name = signal("");
    private readonly closed = signal(false);
    private readonly stopEffect: () => void;

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.name.value = app.store.freeName(command.peek());
        this.stopEffect = effect(() => {
            const { object } = app.store.selection.value;
            const state = app.store.state.value;
            if (this.writes.value === 0 && !this.dragging) {
                const controls = object ? findControls(state, object, kCommands) : null;
                const spatial = controls?.points.every((point) => point.length === 3) ? controls : null;
                untracked(() => this.read(spatial, object));
            }
        });
    }

    private get controls(): Controls | null {
        return this.edited.value;
    }

    private read(controls: Controls | null, object: ObjectName | null): void {
        if (controls || this.controls) {
            this.edited.value = controls;
            this.object = controls ? object : null;
            this.points = (controls?.points ?? []) as Point[];
            this.active = Math.min(this.active, this.points.length - 1);
        }
        this.draw();
    }

    stop(): void {
        this.stopEffect();
        this.gesture?.cancel();
        this.overlay.stop();
    }

    status(): string {
        if (this.gesture?.refusal && this.points.length > 1) {
            return this.gesture.refusal;
        }
        const typed = this.typed.text !== "" ? ` ${this.typed.text}` : "";
        return this.controls
            ? `Drag points of ${this.controls.name}; click the line to add one, Delete removes one; type x,y,z and Enter.${typed}`
            : `${this.count.value} points. Click to add one, or type x,y,z and Enter; Enter alone ends.${typed}`;
    }

    panel(): VNode {
        if (this.controls) {
            return (
                <div class="tool-row">
                    <Button label="Delete point" run={() => this.remove()} />
                    <Button label="A new curve" run={() => this.renew()} />
                </div>
            );
        }
        return (
            <>
                <ChoiceField label="Becomes" value={command} choices={kChoices} changed={() => this.renamed()} />
                <TextField label="Name" value={this.name} />
                {command.value !== "polygon" && <CheckField label="Closed" value={this.closed} changed={() => this.show()} />}
                <Button label="Make it" run={() => void this.make()} />
            </>
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (event.phase === "down" && event.buttons === 1) {
            return this.press(event);
        }
        if (!this.dragging) {
            return false;
        }
        if (event.phase === "move") {
            this.drag(event);
        } else {
            this.release();
        }
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Enter") {
            this.enter();
            return true;
        }
        if (event.key === "Escape" && ((this.points.length > 0 && !this.controls) || this.typed.text !== "")) {
            this.reset();
            return true;
        }
        if ((event.key === "Delete" || event.key === "Backspace") && this.typed.text === "") {
            return this.remove();
        }
        if (event.key.startsWith("Arrow") && this.active >= 0 && !event.ctrlKey && !event.altKey) {
            this.nudge(event);
            return true;
        }
        if (event.key === "Tab" && this.points.length > 0 && this.app.view.element() === document.activeElement && this.active >= 0) {
            const next = this.active + (event.shiftKey ? -1 : 1);
            if (next >= 0 && next < this.points.length) {
                this.active = next;
                this.draw();
                return true;
            }
            return false;
        }
        return this.typed.key(event);
    }

    private renamed(): void {
        this.name.value = this.app.store.freeName(command.peek());
        this.show();
    }

    private renew(): void {
        this.app.store.selection.value = { ...this.app.store.selection.peek(), object: null, nodes: [] };
        this.renamed();
    }

    private press(event: ToolPointer): boolean {
        const { view } = this.app;
        const pixels = this.points.map((point) => view.toPixels(point));
        const hit = pixels.findIndex(([x, y]) => Math.hypot(x - event.x, y - event.y) < kNear);
        if (hit >= 0) {
            this.active = hit;
        } else {
            const inserted = this.insertAt(event, pixels);
            const at = inserted ?? this.placeOf(event);
            if (!at || (this.controls && inserted === null && this.points.length > 0 && !event.control)) {
                return false; // away from an existing curve: the view rotates; Ctrl and a click append a point
            }
            if (inserted === null) {
                this.points = [...this.points, at];
                this.active = this.points.length - 1;
            }
            this.moved = true;
        }
        this.from = this.points[this.active];
        this.dragging = true;
        this.show();
        return true;
    }

    /** A new point on the clicked segment; null if no segment was clicked. */
    private insertAt(event: ToolPointer, pixels: readonly (readonly number[])[]): Point | null {
        for (let i = 1; i < pixels.length; ++i) {
            const { far, share } = toSegment(event.x, event.y, pixels[i - 1], pixels[i]);
            const through = this.points[i - 1].map((value, k) => value + share * (this.points[i][k] - value)) as Point;
            const at = far < kNear / 2 ? this.app.view.toPlane(event.x, event.y, through) : null;
            if (at) {
                this.points = [...this.points.slice(0, i), at, ...this.points.slice(i)];
                this.active = i;
                return at;
            }
        }
        return null;
    }

    private placeOf(event: ToolPointer): Point | null {
        const { view } = this.app;
        const last = this.points.at(-1);
        if (last) {
            const at = view.toPlane(event.x, event.y, last);
            return at && add(last, this.typed.constrain(subtract(at, last)));
        }
        return view.pick(event.x, event.y)?.point ?? onPlane(view.ray(event.x, event.y), [0, 0, 0], [0, 0, 1]) ?? view.toPlane(event.x, event.y, [0, 0, 0]);
    }

    private drag(event: ToolPointer): void {
        const at = this.from && this.app.view.toPlane(event.x, event.y, this.from);
        if (this.from && at) {
            this.setActive(add(this.from, this.typed.constrain(subtract(at, this.from))));
        }
    }

    private setActive(at: Point): void {
        this.points = this.points.map((point, i) => (i === this.active ? at : point));
        this.moved = true;
        this.show();
    }

    private release(): void {
        this.dragging = false;
        if (this.controls && this.moved) {
            void this.write(false);
        }
        this.moved = false;
    }

    private enter(): void {
        const values = this.typed.values();
        const typed = typedShift(this.typed);
        this.typed.clear();
        if (typed && values) {
            // Three numbers are a position; one number along an axis is relative to the last point.
            const last = this.points.at(-1) ?? [0, 0, 0];
            const at: Point = values.length === 1 ? add(last, typed) : typed;
            if (this.controls && this.active >= 0) {
                this.setActive(at);
                void this.write(false);
            } else {
                this.points = [...this.points, at];
                this.active = this.points.length - 1;
                this.show();
            }
        } else if (!this.controls) {
            void this.make();
        }
    }

    private nudge(event: KeyboardEvent): void {
        const { view } = this.app;
        const at = this.points[this.active];
        const [x, y] = view.toPixels(at);
        const far = kNudge * (event.shiftKey ? 0.1 : 1);
        const dx = event.key === "ArrowRight" ? far : event.key === "ArrowLeft" ? -far : 0;
        const dy = event.key === "ArrowDown" ? far : event.key === "ArrowUp" ? -far : 0;
        const to = view.toPlane(x + dx, y + dy, at);
        if (to) {
            this.setActive(to);
            if (this.controls) {
                void this.write(true);
            }
        }
    }

    private remove(): boolean {
        if (this.active < 0 || (this.controls && this.points.length <= 2)) {
            return false;
        }
        this.points = this.points.filter((_, i) => i !== this.active);
        this.active = this.points.length - 1;
        this.show();
        if (this.controls) {
            void this.write(false);
        }
        return true;
    }

    private line(): string {
        const step = this.points.length > 0 ? this.app.view.pixelSize(this.points[0]) / 10 : 1e-4;
        const closed: Record<string, string> = this.closed.peek() && command.peek() !== "polygon" ? { closed: "true" } : {};
        return this.controls
            ? curveLine(this.controls.name, this.controls, this.points, step)
            : curveLine(this.name.peek(), { command: command.peek(), options: closed, comment: "" }, this.points, step);
    }

    private show(): void {
        this.draw();
        if (this.points.length >= 2) {
            this.gesture ??= new Gesture(this.app, this.object ?? undefined);
            this.gesture.preview(this.line().replace(/ #.*$/, ""));
        }
    }

    // Small steps of a point are undone together.
    private async write(joins: boolean): Promise<void> {
        const { controls } = this;
        if (controls) {
            this.gesture = null;
            const name = joins ? `point ${this.active + 1} of ${controls.name}` : `points of ${controls.name}`;
            ++this.writes.value;
            await replaceStatement(this.app, { statement: controls.statement, text: this.line(), name, joins });
            --this.writes.value;
        }
    }

    private async make(): Promise<void> {
        if (this.points.length < 2) {
            this.app.store.notify("A curve requires at least two points.", "warning");
            return;
        }
        const name = this.name.peek();
        const gesture = this.gesture ?? new Gesture(this.app);
        const line = this.line();
        this.gesture = null;
        if ((await gesture.run(line)) !== null) {
            this.points = [];
            const kind = command.peek() === "path" ? "path" : "solid";
            this.app.store.selection.value = { ...this.app.store.selection.peek(), object: { kind, name }, nodes: [] };
        }
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.dragging = false;
        this.moved = false;
        this.typed.clear();
        this.points = (this.controls?.points ?? []) as Point[];
        this.active = -1;
        this.draw();
    }

    private draw(): void {
        this.count.value = this.points.length;
        this.overlay.clear();
        if (this.points.length > 1) {
            this.overlay.line(this.points, kColors.plain, false, 1); // the curve itself is drawn as a preview
        }
        if (this.points.length > 0) {
            this.overlay.dots(this.points, kColors.plain, 9);
        }
        if (this.active >= 0 && this.active < this.points.length) {
            this.overlay.dots([this.points[this.active]], kColors.hot, 13);
        }
    }
}

export const curveTools: Tool[] = [
    {
        id: "curve",
        label: "Curve",
        group: "crown",
        shortcut: "K",
        help: "Draws a curve through points, for sweeps and skins or as a solid, and edits the points of a selected curve.",
        start: (app) => new CurveRun(app),
    },
];
