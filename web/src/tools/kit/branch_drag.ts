// Common base of all tools that drag a branch: the change is previewed during the drag, and ends as one line.
import { type Signal, signal } from "@preact/signals-core";
import type { App, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Overlay } from "./overlay";
import { Gesture } from "./gesture";
import { finalLine, type NodeLine, previewLine } from "./naming";
import { followSkeletons, pickBranch, selectedTops, type Skeleton, skeletonOf } from "./skeleton";
import { TypedInput } from "./typed_input";
import { subtract } from "./vector";

const kExact = 1e-6;

/** The dragged node; its skeleton is the one from before the drag. */
export interface Held {
    about: ObjectName;
    skeleton: Skeleton;
    n: number;
    ids: number[]; // nodes named in lines: the dragged branch, or the whole selection if it contains that branch
}

export abstract class BranchDragRun implements ToolRun {
    private readonly holds: Signal<Held | null> = signal(null);
    protected readonly typed = new TypedInput();
    protected readonly overlay: Overlay;
    protected from: ToolPointer | null = null;
    protected last: ToolPointer | null = null;
    private gesture: Gesture | null = null;
    private stopped = false;
    private readonly unfollow: () => void;

    constructor(protected readonly app: App) {
        this.overlay = new Overlay(app);
        this.unfollow = followSkeletons(app, () => this.again());
        this.holdSelected();
    }

    protected get held(): Held | null {
        return this.holds.value;
    }

    protected set held(held: Held | null) {
        this.holds.value = held;
    }

    /** The line for the position of the pointer and the typed text; null if there is no change. */
    protected abstract nodeLine(held: Held): NodeLine | null;
    protected abstract text(held: Held | null): string;
    /** Draws the preview of the tool. */
    protected draw(): void {}
    /** The node that is dragged when a node is picked. */
    protected grip(_skeleton: Skeleton, n: number): number {
        return n;
    }
    /** Resets the tool. */
    protected clear(): void {}

    stop(): void {
        this.stopped = true;
        this.unfollow();
        this.gesture?.cancel();
        this.overlay.stop();
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
            const under = this.isInProgress();
            this.reset();
            return under;
        }
        if (this.typed.key(event)) {
            this.show();
            return true;
        }
        return false;
    }

    protected isInProgress(): boolean {
        return this.gesture !== null || this.from !== null || this.typed.text !== "";
    }

    /** The movement of the pointer at the depth of a point, across the line of sight or along the typed axis. */
    protected shift(at: Point): Point {
        const { view } = this.app;
        if (!this.from || !this.last) {
            return [0, 0, 0];
        }
        const now = view.toPlane(this.last.x, this.last.y, at);
        const before = view.toPlane(this.from.x, this.from.y, at);
        return now && before ? this.typed.constrain(subtract(now, before)) : [0, 0, 0];
    }

    /** Resolution of the numbers in the line: for the pointer, or exact for typed ones. */
    protected step(at: Point): number {
        return this.typed.values() ? kExact : this.app.view.pixelSize(at) / 10;
    }

    /** Input from a field of the panel, like typed text. */
    protected type(text: string): void {
        this.typed.text = text;
        this.show();
    }

    /** Updates the preview. */
    protected show(): void {
        const nodeLine = this.held && this.nodeLine(this.held);
        if (this.held && nodeLine) {
            this.gesture ??= new Gesture(this.app, this.held.about);
            this.gesture.preview(previewLine(nodeLine));
        }
        this.draw();
    }

    protected end(): void {
        const nodeLine = this.held && this.nodeLine(this.held);
        const { gesture } = this;
        if (nodeLine && gesture) {
            this.gesture = null;
            this.reset();
            void finalLine(this.app, nodeLine).then((line) => gesture.run(line));
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
        if (!this.stopped && !this.isInProgress()) {
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

    // The whole selection is changed if the pointer drags a part of it; null otherwise.
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
