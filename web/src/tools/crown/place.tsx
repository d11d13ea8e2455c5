// Primitives placed by a drag on the ground or on a surface: first the radius, then the height.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { Point } from "../../protocol";
import { Overlay, kColors } from "../kit/overlay";
import { Button, ChoiceField, NumberField, PointField, pointSignals, TextField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { TypedInput } from "../kit/typed_input";
import { add, distance, kAxes, onLine, onPlane, roundStep, snapped } from "../kit/vector";
import { commandLine, newName, numberWord, pointWord, sizeWord } from "../kit/words";

export type Primitive = "sphere" | "box" | "cylinder" | "cone" | "line" | "circle" | "disc";

const kPrimitives: readonly (readonly [Primitive, string])[] = [
    ["sphere", "Ball"],
    ["box", "Box"],
    ["cylinder", "Cylinder"],
    ["cone", "Cone"],
    ["line", "Capsule"],
    ["circle", "Ring"],
    ["disc", "Disc"],
];

const kRound = 0.1; // relative to the radius: rounding of the edges of boxes, cylinders and cones
const kHigh = new Set<Primitive>(["box", "cylinder", "cone", "line"]);

/** The command of a primitive with its centre, or the centre of its base, at `at`. */
export function primitiveLine(shape: Primitive, name: string, at: Point, radius: number, height: number, step: number): string {
    const size = (value: number) => sizeWord(value, step);
    const place = (point: Point) => pointWord(point, step);
    const round = kRound * Math.min(radius, height / 2);
    const [low, high] = [Math.min(height, 0), Math.max(height, 0)];
    const up = (far: number): Point => add(at, [0, 0, far]);
    switch (shape) {
        case "sphere":
            return commandLine(["sphere", name], { center: place(at), radius: size(radius) });
        case "circle":
            return commandLine(["circle", name], { center: place(at), skeleton_radius: size(radius), radius: size(radius / 4) });
        case "disc":
            return commandLine(["disc", name], {
                center: place(at),
                skeleton_radius: size(radius * (1 - kRound)),
                radius: size(radius * kRound),
            });
        case "line": {
            const cap = Math.min(radius, 0.45 * Math.abs(height)); // the ends must not coincide
            return commandLine(["line", name], { from: place(up(low + cap)), to: place(up(high - cap)), radius: size(radius) });
        }
        case "box": {
            const wide = radius - Math.abs(round);
            const options = {
                low: place(add(at, [-wide, -wide, low + Math.abs(round)])),
                high: place(add(at, [wide, wide, high - Math.abs(round)])),
            };
            return commandLine(["box", name], { ...options, radius: size(Math.abs(round)) });
        }
        case "cylinder":
        case "cone": {
            const r = Math.abs(round);
            const ends = { from: place(up(low + r)), to: place(up(high - r)) };
            const wide = shape === "cone" ? { from_radius: size(radius - r) } : { skeleton_radius: size(radius - r) };
            return commandLine([shape, name], { ...ends, ...wide, radius: size(r) });
        }
    }
}

const shape = signal<Primitive>("sphere");
const kExact = 1e-4; // [m] resolution of typed numbers

/** The fields contain the current primitive: the pointer, keys and the fields themselves change them. */
class PlaceRun implements ToolRun {
    private readonly stage: Signal<"none" | "wide" | "high" | "fields"> = signal("none");
    private readonly name = signal("");
    private readonly center = pointSignals([0, 0, 0]);
    private readonly radius = signal(1);
    private readonly height = signal(2);
    private heightFrom = 0; // of the pointer at the start of the second stage
    private gesture: Gesture | null = null;
    private readonly typed = new TypedInput();
    private readonly overlay: Overlay;
    private readonly unfollow: () => void;

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.rename();
        this.unfollow = effect(() => {
            const isTaken = app.store.state.value.objects.some(({ name }) => name === this.name.peek());
            if (isTaken) {
                this.rename();
            }
        });
    }

    stop(): void {
        this.unfollow();
        this.gesture?.cancel();
        this.overlay.stop();
    }

    status(): string {
        if (this.gesture?.refusal) {
            return this.gesture.refusal;
        }
        switch (this.stage.value) {
            case "none":
                return "Press at its position, and drag to set its radius; or fill in the fields.";
            case "wide":
                return `Radius ${sizeWord(this.radius.value, this.step())} m. Type a radius, or a radius and a height; Enter ends.`;
            case "high":
                return `Height ${sizeWord(Math.abs(this.height.value), this.step())} m. Move and click, or type it; Enter ends.`;
            case "fields":
                return "Enter creates it; Esc discards it.";
        }
    }

    panel(): VNode {
        const changed = () => this.byFields();
        const isHigh = kHigh.has(shape.value);
        return (
            <>
                <ChoiceField label="Shape" value={shape} choices={kPrimitives} changed={() => this.reshape()} />
                <TextField label="Name" value={this.name} />
                <PointField label={isHigh ? "Foot" : "Middle"} value={this.center} changed={changed} />
                <NumberField label="Radius" unit="m" value={this.radius} low={0.001} changed={changed} />
                {isHigh && <NumberField label="Height" unit="m" value={this.height} low={0.001} changed={changed} />}
                <Button label="Make it" run={() => void this.make()} />
            </>
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (event.phase === "down") {
            return event.buttons === 1 ? this.press(event) : false;
        }
        const stage = this.stage.peek();
        if (stage !== "wide" && stage !== "high") {
            return false;
        }
        if (event.phase === "up") {
            this.release(event);
        } else {
            this.follow(event);
        }
        return true;
    }

    key(event: KeyboardEvent): boolean {
        const stage = this.stage.peek();
        if (event.key === "Escape" && stage !== "none") {
            this.reset();
            return true;
        }
        if (event.key === "Enter") {
            void this.make();
            return true;
        }
        if (stage === "none" || stage === "fields" || !this.typed.key(event)) {
            return false;
        }
        const [first, second] = this.typed.values() ?? [];
        if (stage === "high") {
            this.height.value = first ?? this.height.peek();
        } else {
            this.radius.value = Math.abs(first ?? this.radius.peek());
            this.height.value = second ?? this.radius.peek() * 2;
        }
        this.show();
        return true;
    }

    private get at(): Point {
        return this.center.map((value) => value.peek()) as Point;
    }

    private rename(): void {
        this.name.value = this.app.store.freeName(kPrimitives.find(([id]) => id === shape.peek())?.[1].toLowerCase() ?? "solid");
    }

    private reshape(): void {
        this.rename();
        if (this.gesture) {
            this.show();
        }
    }

    // The number of digits depends on the zoom; typed numbers are kept.
    private step(): number {
        const isTyped = this.stage.peek() === "fields" || this.stage.peek() === "none" || this.typed.values() !== null;
        return isTyped ? kExact : this.app.view.pixelSize(this.at) / 10;
    }

    private rounded(value: number): number {
        return Number(numberWord(value, this.step()));
    }

    private press(event: ToolPointer): boolean {
        const { view } = this.app;
        if (this.stage.peek() === "high") {
            this.follow(event);
            return true;
        }
        const ground = onPlane(view.ray(event.x, event.y), [0, 0, 0], kAxes.z);
        const at = view.pick(event.x, event.y)?.point ?? ground ?? view.toPlane(event.x, event.y, [0, 0, 0]);
        if (!at) {
            return false;
        }
        const grid = event.control ? roundStep(20 * view.pixelSize(at)) : 0;
        this.reset();
        this.stage.value = "wide";
        const digits = view.pixelSize(at) / 10;
        [snapped(at[0], grid), snapped(at[1], grid), at[2]].forEach((value, i) => {
            this.center[i].value = Number(numberWord(value, digits));
        });
        this.radius.value = 0;
        return true;
    }

    private follow(event: ToolPointer): void {
        const { view } = this.app;
        if (this.typed.values()) {
            return;
        }
        const { at } = this;
        const grid = event.control ? roundStep(10 * view.pixelSize(at)) : 0;
        if (this.stage.peek() === "wide") {
            const to = onPlane(view.ray(event.x, event.y), at, kAxes.z) ?? view.toPlane(event.x, event.y, at);
            this.radius.value = to ? this.rounded(snapped(distance(to, at), grid)) : this.radius.peek();
            this.height.value = 2 * this.radius.peek();
        } else {
            const high = onLine(view.ray(event.x, event.y), at, kAxes.z);
            if (high !== null) {
                this.height.value = this.rounded(snapped(2 * this.radius.peek() + high - this.heightFrom, grid));
            }
        }
        this.show();
    }

    private release(event: ToolPointer): void {
        const size = this.app.view.pixelSize(this.at);
        const isWide = this.stage.peek() === "wide";
        if (isWide && this.radius.peek() < 3 * size) {
            this.radius.value = this.rounded(40 * size); // a click: a size that is easy to draw
            this.height.value = 2 * this.radius.peek();
            this.show();
        }
        if (isWide && kHigh.has(shape.peek()) && event.type !== "touch") {
            this.stage.value = "high";
            this.heightFrom = onLine(this.app.view.ray(event.x, event.y), this.at, kAxes.z) ?? 0;
            return;
        }
        void this.make();
    }

    private byFields(): void {
        if (this.stage.peek() === "none") {
            this.stage.value = "fields";
        }
        this.show();
    }

    private line(): string {
        const height = Math.abs(this.height.peek()) < this.step() ? this.step() : this.height.peek();
        return primitiveLine(shape.peek(), newName(this.name.peek()), this.at, this.radius.peek(), height, this.step());
    }

    private show(): void {
        this.overlay.clear();
        if (this.radius.peek() > 0) {
            this.overlay.circle(this.at, kAxes.z, this.radius.peek(), kColors.grow);
            this.gesture ??= new Gesture(this.app);
            this.gesture.preview(this.line());
        }
    }

    private async make(): Promise<void> {
        if (!(this.radius.peek() > 0)) {
            this.reset();
            return;
        }
        const wanted = this.name.peek();
        const line = this.line();
        const gesture = this.gesture ?? new Gesture(this.app);
        this.gesture = null;
        this.reset();
        const ran = await gesture.run(line);
        if (ran) {
            const name = ran.names[0] ?? wanted;
            this.app.store.selection.value = { ...this.app.store.selection.peek(), object: { kind: "solid", name }, nodes: [] };
        }
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.stage.value = "none";
        this.typed.clear();
        this.overlay.clear();
    }
}

export const placeTools: Tool[] = [
    {
        id: "place",
        label: "Place",
        group: "crown",
        shortcut: "A",
        help: "Places a ball, box, cylinder, cone, capsule, ring or disc: drag on the ground or a surface, or fill in the fields.",
        start: (app) => new PlaceRun(app),
    },
];
