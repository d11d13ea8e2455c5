// Move, rotate and scale: by handles, by dragging, by following the pointer after a key, or by typed numbers.
import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../app";
import { type Change, changeOf, changeText, type Dragged, isNothing, type Mode, selectedTarget, type Target, turnAbout } from "./kit/change";
import { sight } from "./kit/overlay";
import { AxisButtons, Button, NumberField } from "./kit/fields";
import { Gesture } from "./kit/gesture";
import { Gizmo, type Handle, kRing } from "./kit/gizmo";
import { fetchSkeleton } from "./kit/skeleton";
import { startedByKey } from "./kit/key_start";
import { type Axis, TypedInput } from "./kit/typed_input";
import { numberWord } from "./kit/words";
import { add, kAxes, onLine, roundStep, scaled, subtract } from "./kit/vector";

const kNone: Dragged = { by: [0, 0, 0], turn: 0, factor: 1 };
const kPrecise = 0.1; // of a drag with Shift
const kNudge = 10; // [px] of an arrow key
const kExact = 1e-6; // resolution of typed numbers

class TransformRun implements ToolRun {
    private readonly aimed: Signal<Target | null> = signal(null);
    private gesture: Gesture | null = null;
    private readonly gizmo: Gizmo;
    private readonly typed = new TypedInput();
    private handle: Handle | null = null;
    private hot: Handle | null = null;
    private from: { x: number; y: number } | null = null; // where a drag began
    private dragged: Dragged = kNone;
    private snap = false;
    private following: boolean; // the pointer without a button
    private readonly byKey: boolean;
    private readonly stopEffect: () => void;
    private stopped = false;
    private readonly fields: Signal<number>[] = [signal(0), signal(0), signal(0)];

    constructor(
        private readonly app: App,
        private readonly mode: Mode,
    ) {
        this.gizmo = new Gizmo(app);
        this.byKey = startedByKey();
        this.following = this.byKey;
        this.stopEffect = effect(() => {
            const { object } = app.store.selection.value;
            void app.store.state.value;
            untracked(() => {
                if (object?.kind === "skeleton") {
                    void fetchSkeleton(app, object.name).then(() => this.aim());
                }
                this.aim();
            });
        });
        this.resetFields();
    }

    private get target(): Target | null {
        return this.aimed.value;
    }

    stop(): void {
        this.stopped = true;
        this.stopEffect();
        this.gesture?.cancel();
        this.gizmo.stop();
    }

    pointer(event: ToolPointer): boolean {
        if (!this.target) {
            return false;
        }
        this.snap = event.control;
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (event.phase === "down") {
            return this.press(event);
        }
        if (this.from && (this.following || event.buttons !== 0 || event.phase === "up")) {
            if (event.phase === "move") {
                this.drag(event);
            } else if (!this.following) {
                this.end();
            }
            return true;
        }
        if (this.following && event.phase === "move") {
            this.from = { x: event.x, y: event.y };
            return true;
        }
        this.hot = this.gizmo.at(this.mode, this.target.pivot, event.x, event.y, this.target.evenly);
        this.draw();
        return false;
    }

    wheel(): boolean {
        return this.from !== null; // no zoom during a drag
    }

    key(event: KeyboardEvent): boolean {
        if (!this.target) {
            return false;
        }
        if (event.key === "Enter") {
            this.end();
            return true;
        }
        if (event.key === "Escape") {
            const under = this.isInProgress();
            this.reset();
            return under && !this.byKey;
        }
        if (event.key.startsWith("Arrow") && !event.ctrlKey && !event.altKey) {
            this.nudge(event);
            return true;
        }
        if (this.typed.key(event)) {
            this.show();
            return true;
        }
        return false;
    }

    status(): string {
        if (!this.target) {
            return "Select a solid, a skeleton or branches first.";
        }
        if (this.gesture?.refusal) {
            return this.gesture.refusal;
        }
        const text = changeText(this.change(), this.step());
        const constraint = this.mode === "turn" ? this.typed.constraint().replace("along", "about") : this.typed.constraint();
        const parts = [this.target.label, text, constraint].filter((part) => part !== "");
        return `${parts.join(" ")}. Type numbers, X, Y or Z; Enter ends, Esc discards, Ctrl snaps.`;
    }

    panel(): VNode {
        const labels = this.mode === "turn" ? ["Angle"] : this.target?.evenly && this.mode === "size" ? ["Factor"] : ["X", "Y", "Z"];
        const unit = this.mode === "move" ? "m" : this.mode === "turn" ? "°" : "";
        return (
            <>
                {labels.map((label, i) => (
                    <NumberField key={label} label={label} unit={unit} value={this.fields[i]} changed={() => this.fromFields(labels.length)} />
                ))}
                {this.mode === "turn" && <AxisButtons choose={(axis) => this.choose(axis)} />}
                <Button label="Apply" run={() => this.end()} />
            </>
        );
    }

    private choose(axis: Axis): void {
        this.typed.axis = axis;
        this.typed.plane = false;
        this.show();
    }

    private fromFields(count: number): void {
        this.typed.text = this.fields
            .slice(0, count)
            .map((field) => String(field.peek()))
            .join(",");
        this.show();
    }

    private resetFields(): void {
        this.fields.forEach((field) => {
            field.value = this.mode === "size" ? 1 : 0;
        });
    }

    /** Updates the fields to the change. */
    private fill(change: Change): void {
        const values = change.mode === "move" ? change.by : change.mode === "turn" ? [change.degrees] : change.factors;
        values.forEach((value, i) => {
            this.fields[i].value = Number(numberWord(value, this.mode === "turn" ? 0.01 : this.step()));
        });
    }

    private aim(): void {
        if (!this.stopped && !this.isInProgress()) {
            this.aimed.value = selectedTarget(this.app);
            this.draw();
        }
    }

    private isInProgress(): boolean {
        return this.from !== null || this.gesture !== null || this.typed.text !== "";
    }

    private draw(): void {
        if (this.target) {
            const { pivot, evenly } = this.target;
            const change = this.isInProgress() ? this.change() : null;
            const at = change?.mode === "move" ? add(pivot, change.by) : pivot;
            const guide = change && !this.typed.plane ? this.typed.axis : null;
            this.gizmo.show(this.mode, at, this.handle ?? this.hot, evenly, guide);
        } else {
            this.gizmo.hide();
        }
    }

    private step(): number {
        return this.target && !this.typed.values() ? this.app.view.pixelSize(this.target.pivot) / 10 : kExact;
    }

    private press(event: ToolPointer): boolean {
        if (!this.target || event.buttons !== 1) {
            const under = this.isInProgress() && event.buttons === 2;
            if (under) {
                this.reset();
            }
            return under;
        }
        if (this.following && this.from) {
            this.end(); // a click ends a gesture that a key began
            return true;
        }
        this.following = false;
        const handle = this.gizmo.at(this.mode, this.target.pivot, event.x, event.y, this.target.evenly);
        const pick = handle ? null : this.app.view.pick(event.x, event.y, [this.target.about.kind]);
        if (!handle && pick?.object.name !== this.target.about.name) {
            return false; // away from the handles: the view rotates
        }
        this.handle = handle;
        if (handle) {
            this.typed.axis = handle.axis;
            this.typed.plane = handle.plane;
        }
        this.from = { x: event.x, y: event.y };
        return true;
    }

    private drag(event: ToolPointer): void {
        const { view } = this.app;
        if (!this.target || !this.from) {
            return;
        }
        const { pivot } = this.target;
        const slow = event.shift ? kPrecise : 1;
        const center = view.toPixels(pivot);
        const far = (x: number, y: number) => Math.max(Math.hypot(x - center[0], y - center[1]), 4);
        const factor = far(event.x, event.y) / far(this.from.x, this.from.y);
        this.dragged = { by: scaled(this.shift(event), slow), turn: this.turned(event) * slow, factor: 1 + (factor - 1) * slow };
        this.show();
    }

    private turned(event: ToolPointer): number {
        const { view } = this.app;
        if (!this.target || !this.from) {
            return 0;
        }
        const { pivot } = this.target;
        const into = sight(this.app, pivot);
        const axis = this.typed.axis ? kAxes[this.typed.axis] : scaled(into, -1);
        const [from, to] = [this.from, event].map(({ x, y }) => view.ray(x, y));
        return turnAbout(axis, pivot, from, to, into, kRing * view.pixelSize(pivot));
    }

    /** The movement of the pointer: along the active axis, in its plane, or across the line of sight. */
    private shift(event: ToolPointer): Dragged["by"] {
        const { view } = this.app;
        if (!this.target || !this.from) {
            return [0, 0, 0];
        }
        const { pivot } = this.target;
        const axis = this.typed.axis ? kAxes[this.typed.axis] : null;
        if (axis && !this.typed.plane) {
            const [now, before] = [event, this.from].map(({ x, y }) => onLine(view.ray(x, y), pivot, axis));
            return now === null || before === null ? [0, 0, 0] : scaled(axis, now - before);
        }
        const [now, before] = [event, this.from].map(({ x, y }) => view.toPlane(x, y, pivot, axis ?? undefined));
        return now && before ? subtract(now, before) : [0, 0, 0];
    }

    private nudge(event: KeyboardEvent): void {
        if (!this.target) {
            return;
        }
        const { view } = this.app;
        const away = event.key === "ArrowRight" || event.key === "ArrowUp" ? 1 : -1;
        const upright = event.key === "ArrowUp" || event.key === "ArrowDown";
        const far = (event.shiftKey ? kPrecise : 1) * kNudge * away;
        const [x, y] = view.toPixels(this.target.pivot);
        const to = view.toPlane(upright ? x : x + far, upright ? y - far : y, this.target.pivot);
        const { by, turn, factor } = this.dragged;
        const shift = to ? subtract(to, this.target.pivot) : ([0, 0, 0] as const);
        this.dragged = {
            by: [by[0] + shift[0], by[1] + shift[1], by[2] + shift[2]],
            turn: turn + (far / kNudge) * 5,
            factor: factor * 1.1 ** (far / kNudge),
        };
        this.show();
    }

    private change(): Change {
        const pivot = this.target?.pivot ?? [0, 0, 0];
        return changeOf(this.dragged, {
            mode: this.mode,
            typed: this.typed,
            evenly: this.target?.evenly ?? false,
            sight: sight(this.app, pivot),
            snap: this.snap,
            grid: roundStep(20 * this.app.view.pixelSize(pivot)),
        });
    }

    private show(): void {
        if (!this.target) {
            return;
        }
        const change = this.change();
        this.fill(change);
        this.gesture ??= new Gesture(this.app, this.target.about);
        if (!isNothing(change) || this.gesture.line !== "") {
            this.gesture.preview(this.target.line(change, this.step()));
        }
        this.draw();
    }

    private end(): void {
        const change = this.change();
        const { target, gesture } = this;
        if (target && gesture && !isNothing(change)) {
            const step = this.step();
            this.gesture = null;
            this.clear();
            void target
                .final(change, step)
                .then((line) => gesture.run(line))
                .then(() => this.aim());
        } else {
            this.reset();
        }
        if (this.byKey) {
            this.app.take("select");
        }
    }

    private clear(): void {
        this.from = null;
        this.handle = null;
        this.following = false;
        this.dragged = kNone;
        this.typed.clear();
        this.resetFields();
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.clear();
        this.draw();
    }
}

const enabled = (app: App) => {
    const { object } = app.store.selection.peek();
    return object?.kind === "solid" || object?.kind === "skeleton";
};

export const transformTools: Tool[] = [
    {
        id: "move",
        label: "Move",
        group: "view",
        shortcut: "G",
        help: "Moves the selected solid, skeleton or branches: drag a handle, or type the distances along x, y and z.",
        enabled,
        start: (app) => new TransformRun(app, "move"),
    },
    {
        id: "turn",
        label: "Turn",
        group: "view",
        shortcut: "R",
        help: "Rotates the selection about its centre, or branches about their joints: drag a ring, or type degrees.",
        enabled,
        start: (app) => new TransformRun(app, "turn"),
    },
    {
        id: "size",
        label: "Size",
        group: "view",
        shortcut: "S",
        help: "Scales the selection along one axis or all: drag a handle, or type a factor.",
        enabled,
        start: (app) => new TransformRun(app, "size"),
    },
];
