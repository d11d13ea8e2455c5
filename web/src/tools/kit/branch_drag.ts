// What all tools share that take hold of a branch, change it while they drag, and end as one line.
import { type Signal, signal } from "@preact/signals-core";
import type { App, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Drawn } from "./drawn";
import { Gesture } from "./gesture";
import { finalLine, type NodeLine, previewLine } from "./naming";
import { followSkeletons, pickBranch, selectedTops, type Skeleton, skeletonOf } from "./skeleton";
import { Typed } from "./typed";
import { subtract } from "./vector";

const kExact = 1e-6;

/** A node that is held; its skeleton is the one from before the drag. */
export interface Held {
    about: ObjectName;
    skeleton: Skeleton;
    n: number;
    ids: number[]; // what lines name: the held branch, or all that are selected where it is one of them
}

export abstract class BranchDragRun implements ToolRun {
    private readonly holds: Signal<Held | null> = signal(null);
    protected readonly typed = new Typed();
    protected readonly drawn: Drawn;
    protected from: ToolPointer | null = null;
    protected last: ToolPointer | null = null;
    private gesture: Gesture | null = null;
    private stopped = false;
    private readonly unfollow: () => void;

    constructor(protected readonly app: App) {
        this.drawn = new Drawn(app);
        this.unfollow = followSkeletons(app, () => this.again());
        this.holdSelected();
    }

    protected get held(): Held | null {
        return this.holds.value;
    }

    protected set held(held: Held | null) {
        this.holds.value = held;
    }

    /** The line by where the pointer is and what was typed; null where there is nothing to do. */
    protected abstract made(held: Held): NodeLine | null;
    protected abstract text(held: Held | null): string;
    /** What is shown in the picture. */
    protected draw(): void {}
    /** The node that is taken hold of by one that was picked. */
    protected grip(_skeleton: Skeleton, n: number): number {
        return n;
    }
    /** Back to where nothing was done. */
    protected clear(): void {}

    stop(): void {
        this.stopped = true;
        this.unfollow();
        this.gesture?.cancel();
        this.drawn.stop();
    }

    status(): string {
        return this.gesture?.refusal || this.text(this.held);
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            return this.press(event);
        }
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (event.phase === "move" && event.buttons === 0) {
            return false;
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
        if (event.key === "Escape") {
            const under = this.underway();
            this.reset();
            return under;
        }
        if (this.typed.key(event)) {
            this.show();
            return true;
        }
        return false;
    }

    protected underway(): boolean {
        return this.gesture !== null || this.from !== null || this.typed.text !== "";
    }

    /** How far the pointer went at the depth of a point, across the line of sight or along what was typed. */
    protected shift(at: Point): Point {
        const { view } = this.app;
        if (!this.from || !this.last) {
            return [0, 0, 0];
        }
        const now = view.toPlane(this.last.x, this.last.y, at);
        const before = view.toPlane(this.from.x, this.from.y, at);
        return now && before ? this.typed.constrain(subtract(now, before)) : [0, 0, 0];
    }

    /** How exact numbers of the line are: as the hand is, or as they were typed. */
    protected step(at: Point): number {
        return this.typed.values() ? kExact : this.app.view.pixelSize(at) / 10;
    }

    /** From a field of the panel, as if it was typed. */
    protected type(text: string): void {
        this.typed.text = text;
        this.show();
    }

    /** Shows what there is to be shown now. */
    protected show(): void {
        const made = this.held && this.made(this.held);
        if (this.held && made) {
            this.gesture ??= new Gesture(this.app, this.held.about);
            this.gesture.preview(previewLine(made));
        }
        this.draw();
    }

    protected end(): void {
        const made = this.held && this.made(this.held);
        const { gesture } = this;
        if (made && gesture) {
            this.gesture = null;
            this.reset();
            void finalLine(this.app, made).then((line) => gesture.run(line));
        } else {
            this.reset();
        }
    }

    protected reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.from = null;
        this.last = null;
        this.typed.clear();
        this.clear();
        this.holdSelected();
        this.draw();
    }

    private again(): void {
        if (!this.stopped && !this.underway()) {
            this.holdSelected();
            this.draw();
        }
    }

    private press(event: ToolPointer): boolean {
        const pick = pickBranch(this.app, event.x, event.y);
        const skeleton = pick && skeletonOf(this.app, pick.object.name);
        const n = skeleton && pick?.node !== undefined ? skeleton.index(pick.node) : -1;
        if (!pick || !skeleton || n < 0) {
            return false;
        }
        const node = this.grip(skeleton, n);
        const ids = this.idsWith(pick.object, skeleton, node);
        this.held = { about: pick.object, skeleton, n: node, ids: ids ?? [skeleton.ids[node]] };
        if (!ids) {
            const { selection } = this.app.store;
            selection.value = { ...selection.peek(), object: pick.object, nodes: [skeleton.ids[n]] };
        }
        this.from = event;
        this.last = event;
        this.draw();
        return true;
    }

    // A selection is worked on as a whole where the pointer takes hold of a part of it; null where it does not.
    private idsWith(object: ObjectName, skeleton: Skeleton, n: number): number[] | null {
        const { nodes, extent, object: selected } = this.app.store.selection.peek();
        const same = selected?.kind === "skeleton" && selected.name === object.name;
        const chosen = same ? skeleton.selected(nodes, extent) : [];
        if (!chosen.includes(n)) {
            return null;
        }
        const tops = skeleton.highest(chosen);
        return tops.length > 1 ? tops.map((top) => skeleton.ids[top]) : [skeleton.ids[n]];
    }

    protected holdSelected(): void {
        const chosen = selectedTops(this.app);
        this.held = null;
        if (chosen) {
            const { skeleton, name, ids } = chosen;
            const picked = skeleton.index(this.app.store.selection.peek().nodes[0]);
            const n = this.grip(skeleton, picked >= 0 ? picked : skeleton.index(ids[0]));
            const several = ids.length > 1 ? ids : [skeleton.ids[n]];
            this.held = { about: { kind: "skeleton", name }, skeleton, n, ids: several };
        }
    }
}
