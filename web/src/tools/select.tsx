// The default tool: hovers, picks objects and branches, and moves along them by keys.
import { type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Pick, Tool, ToolPointer, ToolRun } from "../app";
import type { ObjectName, Point } from "../protocol";
import { deleteSelected } from "./branch/cut";
import { ChoiceField } from "./kit/fields";
import { type Extent, fetchSkeleton, kExtents, type Skeleton, skeletonOf } from "./kit/skeleton";

const kStill = 4; // [px] maximum movement of a click

const kExtentLabels: readonly (readonly [Extent, string])[] = [
    ["node", "Node (1)"],
    ["branch", "Branch (2)"],
    ["subtree", "Branch and its subtree (3)"],
    ["tree", "Tree (4)"],
    ["connected", "From fork to fork (5)"],
];

const extentField: Signal<Extent> = signal("branch");

export function setExtent(app: App, extent: Extent): void {
    extentField.value = extent;
    app.store.selection.value = { ...app.store.selection.peek(), extent };
}

/** Selects the picked object or node; with `more` it is added to the selection, or removed from it. */
export function choose(app: App, pick: Pick | null, more: boolean): void {
    const { selection } = app.store;
    const now = selection.peek();
    if (!pick) {
        if (!more) {
            selection.value = { ...now, object: null, nodes: [] };
        }
        return;
    }
    const same = now.object?.kind === pick.object.kind && now.object.name === pick.object.name;
    const id = pick.node;
    if (id === undefined) {
        selection.value = { ...now, object: pick.object, nodes: [] };
    } else if (more && same) {
        const nodes = now.nodes.includes(id) ? now.nodes.filter((other) => other !== id) : [...now.nodes, id];
        selection.value = { ...now, nodes };
    } else {
        selection.value = { ...now, object: pick.object, nodes: [id] };
    }
    if (pick.object.kind === "skeleton") {
        void fetchSkeleton(app, pick.object.name);
    }
}

type Step = "parent" | "child" | "before" | "after";

/** The node after a step along the skeleton; the same node if there is no next one. */
export function stepped(skeleton: Skeleton, n: number, step: Step): number {
    if (step === "parent") {
        return skeleton.parent(n) < 0 ? n : skeleton.parent(n);
    }
    if (step === "child") {
        const leader = skeleton.leader(n);
        return leader < 0 ? n : leader;
    }
    const parent = skeleton.parent(n);
    const siblings = parent < 0 ? skeleton.roots() : skeleton.children[parent];
    const at = siblings.indexOf(n) + (step === "after" ? 1 : -1);
    return siblings[(at + siblings.length) % siblings.length];
}

const kSteps: Record<string, Step> = {
    "[": "parent",
    "]": "child",
    ",": "before",
    ".": "after",
    "Shift+ArrowDown": "parent",
    "Shift+ArrowUp": "child",
    "Shift+ArrowLeft": "before",
    "Shift+ArrowRight": "after",
};

class SelectRun implements ToolRun {
    private pressed: { x: number; y: number } | null = null;

    constructor(private readonly app: App) {}

    stop(): void {
        this.pressed = null;
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down") {
            this.pressed = event.buttons === 1 ? { x: event.x, y: event.y } : null;
        } else if (event.phase === "up" && this.pressed) {
            const still = Math.hypot(event.x - this.pressed.x, event.y - this.pressed.y) <= kStill;
            if (still) {
                choose(this.app, this.app.view.pick(event.x, event.y), event.shift || event.control);
            }
            this.pressed = null;
        }
        return false; // a drag rotates the view
    }

    key(event: KeyboardEvent): boolean {
        if (event.ctrlKey || event.metaKey || event.altKey) {
            return false;
        }
        const extent = /^[1-5]$/.test(event.key) ? kExtents[Number(event.key) - 1] : undefined;
        if (extent && !event.code.startsWith("Numpad")) {
            setExtent(this.app, extent);
            return true;
        }
        const step = kSteps[event.shiftKey && event.key.startsWith("Arrow") ? `Shift+${event.key}` : event.key];
        if (step) {
            return this.walk(step);
        }
        if (event.key === "+" || event.key === "-") {
            return this.resize(event.key === "+");
        }
        if (event.key === "Delete" || event.key === "Backspace") {
            return deleteSelected(this.app);
        }
        if (event.key === "Escape" && this.app.store.selection.peek().object) {
            choose(this.app, null, false);
            return true;
        }
        return false;
    }

    status(): string {
        const { object, nodes, extent } = this.app.store.selection.value;
        if (!object) {
            return "Click an object to select it.";
        }
        const skeleton = object.kind === "skeleton" ? skeletonOf(this.app, object.name) : null;
        const count = skeleton && nodes.length > 0 ? skeleton.selected(nodes, extent).length : 0;
        const name = `${object.kind} ${object.name}`;
        return count > 0 ? `${name}: ${count} nodes selected.` : `${name} is selected.`;
    }

    panel(): VNode {
        const { extent } = this.app.store.selection.value;
        extentField.value = extent;
        const changed = () => setExtent(this.app, extentField.peek());
        return <ChoiceField label="Picks" value={extentField} choices={kExtentLabels} changed={changed} />;
    }

    private selectedSkeleton(): { object: ObjectName; skeleton: Skeleton } | null {
        const { object } = this.app.store.selection.peek();
        const skeleton = object?.kind === "skeleton" ? skeletonOf(this.app, object.name) : null;
        if (object?.kind === "skeleton" && !skeleton) {
            void fetchSkeleton(this.app, object.name);
        }
        return object && skeleton ? { object, skeleton } : null;
    }

    private walk(step: Step): boolean {
        const found = this.selectedSkeleton();
        if (!found) {
            return false;
        }
        const { nodes } = this.app.store.selection.peek();
        const n = found.skeleton.index(nodes.at(-1) ?? -1);
        const next = n < 0 ? 0 : stepped(found.skeleton, n, step);
        this.take(found.object, [found.skeleton.ids[next]]);
        return true;
    }

    private resize(more: boolean): boolean {
        const found = this.selectedSkeleton();
        const { nodes, extent } = this.app.store.selection.peek();
        if (!found || nodes.length === 0) {
            return false;
        }
        const now = found.skeleton.selected(nodes, extent);
        const next = more ? found.skeleton.grown(now) : found.skeleton.shrunk(now);
        if (next.length > 0) {
            setExtent(this.app, "node");
            this.take(
                found.object,
                next.map((n) => found.skeleton.ids[n]),
            );
        }
        return true;
    }

    private take(object: ObjectName, nodes: number[]): void {
        this.app.store.selection.value = { ...this.app.store.selection.peek(), object, nodes };
    }
}

/** The nodes inside a box of the view. */
export function nodesInBox(skeleton: Skeleton, box: readonly [number, number, number, number], toPixels: (point: Point) => [number, number, number]): number[] {
    const [left, right] = [Math.min(box[0], box[2]), Math.max(box[0], box[2])];
    const [top, bottom] = [Math.min(box[1], box[3]), Math.max(box[1], box[3])];
    return skeleton.all().filter((n) => {
        const [x, y, depth] = toPixels(skeleton.at(n));
        return Math.abs(depth) <= 1 && x >= left && x <= right && y >= top && y <= bottom;
    });
}

class BoxRun implements ToolRun {
    private from: { x: number; y: number } | null = null;
    private readonly frame = document.createElement("div");

    constructor(private readonly app: App) {
        this.frame.className = "tool-box";
        this.frame.hidden = true;
        app.view.element().parentElement?.append(this.frame);
        const { object } = app.store.selection.peek();
        if (object?.kind === "skeleton") {
            void fetchSkeleton(app, object.name);
        }
    }

    stop(): void {
        this.frame.remove();
    }

    status(): string {
        return "Drag a box around nodes; with Shift they are added to the selection.";
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            this.from = { x: event.x, y: event.y };
        } else if (event.phase === "move" && this.from) {
            this.place(event);
        } else if (event.phase === "up" && this.from) {
            void this.take([this.from.x, this.from.y, event.x, event.y], event.shift);
            this.end();
        } else if (event.phase === "cancel") {
            this.end();
        } else {
            return false;
        }
        return true;
    }

    private place(event: ToolPointer): void {
        if (this.from) {
            const { style } = this.frame;
            this.frame.hidden = false;
            style.left = `${Math.min(this.from.x, event.x)}px`;
            style.top = `${Math.min(this.from.y, event.y)}px`;
            style.width = `${Math.abs(event.x - this.from.x)}px`;
            style.height = `${Math.abs(event.y - this.from.y)}px`;
        }
    }

    private end(): void {
        this.from = null;
        this.frame.hidden = true;
    }

    private async take(box: [number, number, number, number], more: boolean): Promise<void> {
        const { selection, state } = this.app.store;
        const now = selection.peek();
        const first = state.peek().objects.find(({ kind }) => kind === "skeleton");
        const chosen = now.object?.kind === "skeleton" ? now.object : first;
        const skeleton = chosen && (await fetchSkeleton(this.app, chosen.name));
        if (!chosen || !skeleton) {
            this.app.store.notify("There is no skeleton with nodes to select.", "warning");
            return;
        }
        const toPixels = (point: Point) => this.app.view.toPixels(point);
        const inside = nodesInBox(skeleton, box, toPixels).map((n) => skeleton.ids[n]);
        const kept = more && now.object?.name === chosen.name ? now.nodes : [];
        const nodes = [...new Set([...kept, ...inside])];
        selection.value = { object: { kind: "skeleton", name: chosen.name }, nodes, extent: "node" };
    }
}

export const selectTools: Tool[] = [
    {
        id: "select",
        label: "Select",
        group: "view",
        shortcut: "V",
        help: "Picks objects, and nodes, branches or trees of skeletons; keys 1 to 5 set the extent, + and - grow and shrink the selection.",
        start: (app) => new SelectRun(app),
    },
    {
        id: "box",
        label: "Box",
        group: "view",
        shortcut: "B",
        help: "Selects the nodes of a skeleton inside a box of the view.",
        enabled: (app) => app.store.state.peek().objects.some(({ kind }) => kind === "skeleton"),
        start: (app) => new BoxRun(app),
    },
];
