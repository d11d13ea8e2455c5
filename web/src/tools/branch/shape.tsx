// Straighten, smooth, taper and mirror: one amount each, by a horizontal drag, a typed number or a field.
import { type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool } from "../../app";
import { BranchDragRun, type Held } from "../kit/branch_drag";
import { CheckField, NumberField } from "../kit/fields";
import type { NodeLine } from "../kit/naming";
import { kAxes } from "../kit/vector";
import { commandLine, directionWord, numberWord, sizeWord } from "../kit/words";
import { anySkeleton } from "./cut";

/** The effect of an amount on branches. */
interface Shape {
    id: string;
    label: string;
    help: string;
    field: string;
    first: number;
    low: number;
    high: number;
    perPixel: number; // of a drag
    line(name: string, nodes: string, amount: number): string;
}

const kShapes: Shape[] = [
    {
        id: "straighten",
        label: "Straighten",
        help: "Straightens the selected branches: drag horizontally, or type an amount; 1 is completely straight.",
        field: "Amount",
        first: 1,
        low: 0,
        high: 1,
        perPixel: 1 / 200,
        line: (name, nodes, amount) => commandLine(["edit", "straighten", name, nodes], { amount: numberWord(amount, 0.01) }),
    },
    {
        id: "smooth",
        label: "Smooth",
        help: "Smooths the course of the selected branches: drag horizontally, or type the number of passes.",
        field: "Passes",
        first: 4,
        low: 1,
        high: 1000,
        perPixel: 1 / 20,
        line: (name, nodes, amount) => commandLine(["edit", "smooth", name, `axis(${nodes})`], { passes: Math.round(amount) }),
    },
    {
        id: "taper-branch",
        label: "Taper",
        help: "Tapers the selected branches evenly: drag horizontally, or type the radius at the tip in metres.",
        field: "Radius at the tip [m]",
        first: 0,
        low: 0,
        high: 1e6,
        perPixel: 0,
        line: (name, nodes, amount) => commandLine(["edit", "taper", name, nodes], { to: amount > 0 ? sizeWord(amount, 1e-5) : undefined }),
    },
];

class ShapeRun extends BranchDragRun {
    private readonly amount: Signal<number>;
    private requested = false; // requested by the field

    constructor(
        app: App,
        private readonly shape: Shape,
    ) {
        super(app);
        this.amount = signal(shape.first);
    }

    panel(): VNode {
        const { field, low, high } = this.shape;
        return <NumberField label={field} value={this.amount} low={low} high={high} changed={() => this.requestPreview()} />;
    }

    protected nodeLine(held: Held): NodeLine | null {
        if (!this.isInProgress()) {
            return null;
        }
        const { name } = held.about;
        const tops = held.skeleton.highest(held.ids.map((id) => held.skeleton.axisStart(held.skeleton.index(id))));
        const ids = tops.map((n) => held.skeleton.ids[n]);
        const amount = this.now(held);
        return { name, nodes: [ids], line: ([nodes]) => this.shape.line(name, nodes, amount) };
    }

    protected text(held: Held | null): string {
        return held
            ? `${this.shape.label}: ${numberWord(this.now(held), 1e-4)}. Drag horizontally or type; Enter ends.`
            : "Drag over a branch, or select branches first.";
    }

    protected override isInProgress(): boolean {
        return super.isInProgress() || this.requested;
    }

    protected override clear(): void {
        this.requested = false;
    }

    // Enter alone applies the amount of the field.
    override key(event: KeyboardEvent): boolean {
        if (event.key === "Enter" && this.held && !this.isInProgress()) {
            this.requestPreview();
        }
        return super.key(event);
    }

    private requestPreview(): void {
        this.requested = true;
        this.show();
    }

    private now(held: Held): number {
        const typed = this.typed.values()?.[0];
        const { low, high, perPixel } = this.shape;
        const dragged = this.from && this.last ? this.last.x - this.from.x : 0;
        // A radius changes by factors of the current one, other amounts by steps.
        const tip = held.skeleton.radius[held.skeleton.axis(held.n).at(-1) ?? held.n];
        const by = perPixel > 0 ? this.amount.value + dragged * perPixel : dragged === 0 ? this.amount.value : tip * Math.exp(dragged / 150);
        return Math.min(Math.max(typed ?? by, low), high);
    }
}

const copies = signal(false);

class MirrorRun extends BranchDragRun {
    private requested = false;

    panel(): VNode {
        return <CheckField label="Keep the originals, and add mirrored copies" value={copies} changed={() => this.requestPreview()} />;
    }

    override key(event: KeyboardEvent): boolean {
        if (event.key === "Enter" && this.held && !this.isInProgress()) {
            this.requestPreview();
        }
        return super.key(event);
    }

    protected nodeLine(held: Held): NodeLine | null {
        if (!this.isInProgress()) {
            return null;
        }
        const { name } = held.about;
        const options = { normal: directionWord(kAxes[this.typed.axis ?? "x"]), copy: copies.peek() || undefined };
        return { name, nodes: [held.ids], line: ([nodes]) => commandLine(["edit", "mirror", name, nodes], options) };
    }

    protected text(held: Held | null): string {
        return held
            ? `Mirrors across ${(this.typed.axis ?? "x").toUpperCase()}. X, Y or Z select the axis; Enter or a click on the branch ends.`
            : "Click a branch to mirror it, or select branches first.";
    }

    protected override isInProgress(): boolean {
        return super.isInProgress() || this.requested || this.typed.axis !== null;
    }

    protected override clear(): void {
        this.requested = false;
    }

    private requestPreview(): void {
        this.requested = true;
        this.show();
    }
}

export const shapeTools: Tool[] = [
    ...kShapes.map((shape) => ({
        id: shape.id,
        label: shape.label,
        group: "branch" as const,
        help: shape.help,
        enabled: anySkeleton,
        start: (app: App) => new ShapeRun(app, shape),
    })),
    {
        id: "mirror",
        label: "Mirror",
        group: "branch",
        help: "Mirrors branches in the plane through their joints across X, Y or Z, or adds mirrored copies.",
        enabled: anySkeleton,
        start: (app) => new MirrorRun(app),
    },
];
