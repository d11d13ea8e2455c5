// Twists, tapers and bends solids by a handle at their end.
import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point, SceneObject } from "../../protocol";
import { Overlay, kColors } from "../kit/overlay";
import { AxisButtons, Button, NumberField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { type Axis, TypedInput } from "../kit/typed_input";
import { across, add, angleBetween, distance, kAxes, length, normalized, rotated, scaled, snapped, subtract } from "../kit/vector";
import { commandLine, directionWord, numberWord, pointWord, sizeWord } from "../kit/words";

export type Warp = "twist" | "taper" | "bend";

/** The centres of the two sides of a box across an axis. */
export function warpAxis(bounds: SceneObject["bounds"], axis: Axis): [Point, Point] {
    const at = "xyz".indexOf(axis);
    const middle = [0, 1, 2].map((i) => (bounds[i] + bounds[i + 3]) / 2);
    const end = (side: number) => middle.map((value, i) => (i === at ? bounds[i + side] : value)) as Point;
    return [end(0), end(3)];
}

export interface Warped {
    amount: number; // total twist in degrees, a factor, or bend in degrees
    side: Point;
}

/** The amount for a drag of the handle at the far end. */
export function warpOf(warp: Warp, from: Point, to: Point, by: Point, pixels: number): Warped {
    const along = normalized(subtract(to, from));
    const side = normalized(across(by, along), [1, 0, 0]);
    if (warp === "twist") {
        return { amount: pixels / 2, side };
    }
    if (warp === "taper") {
        return { amount: Math.min(Math.max(Math.exp(pixels / 150), 0.01), 100), side };
    }
    const moved = add(to, across(by, along));
    const chord = (angleBetween(subtract(to, from), subtract(moved, from)) * 180) / Math.PI;
    return { amount: Math.min(2 * chord, 180), side }; // the end of an arc rotates by twice the angle of its chord
}

export function warpLine(warp: Warp, name: string, [from, to]: [Point, Point], { amount, side }: Warped, upright: boolean, step: number): string {
    const axis = normalized(subtract(to, from));
    const ends = upright ? {} : { from: pointWord(from, step), to: pointWord(to, step) };
    switch (warp) {
        case "twist": {
            const rate = numberWord(amount / Math.max(distance(from, to), 1e-9), 0.01);
            const options = { origin: pointWord(from, step), axis: upright ? undefined : directionWord(axis) };
            return commandLine(["twist", name, rate], options);
        }
        case "taper":
            return commandLine(["taper", name, sizeWord(amount, 1e-3)], ends);
        case "bend":
            return commandLine(["bend", name, numberWord(amount, 0.05)], { ...ends, side: directionWord(side) });
    }
}

/** The axis of a bent solid: an arc of the same length. */
export function bentAxis([from, to]: [Point, Point], { amount, side }: Warped, parts = 24): Point[] {
    const far = distance(from, to);
    const along = normalized(subtract(to, from));
    const angle = (amount * Math.PI) / 180;
    return Array.from({ length: parts + 1 }, (_, i) => {
        const turned = (angle * i) / parts;
        const [up, out] = Math.abs(angle) < 1e-6 ? [(far * i) / parts, 0] : [(far / angle) * Math.sin(turned), (far / angle) * (1 - Math.cos(turned))];
        return add(from, add(scaled(along, up), scaled(side, out)));
    });
}

const kNear = 24; // [px]

class WarpRun implements ToolRun {
    private readonly aimed: Signal<SceneObject | null> = signal(null);
    private gesture: Gesture | null = null;
    private from: ToolPointer | null = null;
    private last: ToolPointer | null = null;
    private handles: Point[] = [];
    private readonly typed = new TypedInput();
    private readonly overlay: Overlay;
    private readonly stopEffect: () => void;
    private readonly field;

    constructor(
        private readonly app: App,
        private readonly warp: Warp,
    ) {
        this.overlay = new Overlay(app);
        this.field = signal(warp === "taper" ? 1 : 0);
        this.stopEffect = effect(() => {
            const { object } = app.store.selection.value;
            void app.store.state.value;
            if (!this.gesture) {
                this.aimed.value = object?.kind === "solid" ? (app.store.find("solid", object.name) ?? null) : null;
                untracked(() => this.draw());
            }
        });
    }

    private get solid(): SceneObject | null {
        return this.aimed.value;
    }

    stop(): void {
        this.stopEffect();
        this.gesture?.cancel();
        this.overlay.stop();
    }

    status(): string {
        if (!this.solid) {
            return "Select a solid first.";
        }
        const unit = this.warp === "taper" ? "" : "°";
        return (
            this.gesture?.refusal ||
            `${this.solid.name}: ${numberWord(this.warped().amount, 0.01)}${unit}. Drag the handle or type; X, Y, Z are axes; Enter ends.`
        );
    }

    panel(): VNode {
        const label = { twist: "Total degrees", taper: "Factor at the end", bend: "Degrees" }[this.warp];
        return (
            <>
                <NumberField
                    label={label}
                    value={this.field}
                    changed={() => {
                        this.typed.text = String(this.field.peek());
                        this.show();
                    }}
                />
                <AxisButtons
                    choose={(axis) => {
                        this.typed.axis = axis;
                        this.show();
                    }}
                />
                <Button label="Apply" run={() => this.end()} />
            </>
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1 && this.solid) {
            const { view } = this.app;
            const pixels = this.handles.map((handle) => view.toPixels(handle));
            const isNear = pixels.some(([x, y]) => Math.hypot(event.x - x, event.y - y) < kNear);
            if (!isNear && view.pick(event.x, event.y, ["solid"])?.object.name !== this.solid.name) {
                return false;
            }
            this.from = event;
            this.last = event;
            return true;
        }
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (!this.from) {
            return false;
        }
        this.last = event;
        if (event.phase === "up") {
            this.end();
        } else {
            this.show();
        }
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Enter") {
            this.end();
            return true;
        }
        if (event.key === "Escape" && this.gesture) {
            this.reset();
            return true;
        }
        if (this.solid && this.typed.key(event)) {
            this.show();
            return true;
        }
        return false;
    }

    private ends(): [Point, Point] {
        return warpAxis(this.solid?.bounds ?? [0, 0, 0, 1, 1, 1], this.typed.axis ?? "z");
    }

    private warped(): Warped {
        const [from, to] = this.ends();
        let by: Point = [0, 0, 0];
        let pixels = 0;
        if (this.from && this.last) {
            const { view } = this.app;
            const now = view.toPlane(this.last.x, this.last.y, to);
            const before = view.toPlane(this.from.x, this.from.y, to);
            by = now && before ? subtract(now, before) : by;
            pixels = this.last.x - this.from.x;
        }
        const dragged = warpOf(this.warp, from, to, by, pixels);
        const snap = this.last?.control && this.warp !== "taper" ? snapped(dragged.amount, 5) : dragged.amount;
        return { amount: this.typed.values()?.[0] ?? snap, side: length(by) > 0 ? dragged.side : this.side };
    }

    private line(about: ObjectName): string {
        const upright = (this.typed.axis ?? "z") === "z";
        return warpLine(this.warp, about.name, this.ends(), this.warped(), upright, this.app.view.pixelSize(this.ends()[1]) / 10);
    }

    private show(): void {
        if (this.solid) {
            this.gesture ??= new Gesture(this.app, { kind: "solid", name: this.solid.name });
            this.gesture.preview(this.line(this.solid));
            this.field.value = Number(numberWord(this.warped().amount, 0.01));
            this.draw();
        }
    }

    private end(): void {
        const { gesture, solid } = this;
        const { amount } = this.warped();
        if (gesture && solid && amount !== (this.warp === "taper" ? 1 : 0)) {
            const line = this.line(solid);
            this.gesture = null;
            this.reset();
            void gesture.run(line);
        } else {
            this.reset();
        }
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.from = null;
        this.last = null;
        this.typed.clear();
        this.field.value = this.warp === "taper" ? 1 : 0;
        this.draw();
    }

    private draw(): void {
        this.overlay.clear();
        if (!this.solid) {
            return;
        }
        const ends = this.ends();
        const warped = this.warped();
        const color = kColors[this.typed.axis ?? "z"];
        if (this.warp === "bend") {
            const arc = bentAxis(ends, warped);
            this.overlay.line(arc, color);
            this.handles = arc.slice(-1);
            this.overlay.dots(this.handles, kColors.hot, 13);
            return;
        }
        const [from, to] = ends;
        const along = normalized(subtract(to, from));
        const { radius } = this;
        const spoke = (end: Point, far: number, turn = 0) => add(end, scaled(rotated(this.side, along, turn), far));
        const isTwist = this.warp === "twist";
        const wide = isTwist ? radius : radius * warped.amount;
        const rim = spoke(to, wide, isTwist ? (warped.amount * Math.PI) / 180 : 0);
        this.overlay.line([from, to], color);
        this.overlay.circle(from, along, radius, color);
        this.overlay.circle(to, along, wide, kColors.hot);
        this.overlay.line([spoke(from, radius), from], color);
        this.overlay.line([to, rim], kColors.hot);
        this.handles = [to, rim];
        this.overlay.dots(this.handles, kColors.hot, 13);
    }

    /** Across the axis: the direction of a bend without a drag. */
    private get side(): Point {
        return this.typed.axis === "x" ? kAxes.z : kAxes.x;
    }

    /** Radius of the circles that show the rotation or scale of the ends. */
    private get radius(): number {
        const [x0, y0, z0, x1, y1, z1] = this.solid?.bounds ?? [0, 0, 0, 1, 1, 1];
        const sizes = { x: x1 - x0, y: y1 - y0, z: z1 - z0 };
        const axis = this.typed.axis ?? "z";
        return Math.max(...Object.entries(sizes).map(([name, size]) => (name === axis ? 0 : size / 2)));
    }
}

const solidSelected = (app: App) => app.store.selection.peek().object?.kind === "solid";

const kTools: readonly (readonly [Warp, string, string])[] = [
    ["twist", "Twist", "Twists the selected solid about its axis: drag the handle at its end sideways, or type degrees."],
    ["taper", "Taper", "Makes the selected solid narrower or wider towards its end: drag the handle sideways, or type a factor."],
    ["bend", "Bend", "Bends the selected solid: drag the handle at its end to its new position, or type degrees."],
];

export const warpTools: Tool[] = kTools.map(([warp, label, help]) => ({
    id: `${warp}-solid`,
    label,
    group: "crown",
    help,
    enabled: solidSelected,
    start: (app: App) => new WarpRun(app, warp),
}));
