// Cuts and detaches branches: selected ones by a key, or a clicked one.
import type { App, Pick, Tool, ToolPointer, ToolRun } from "../../app";
import { Overlay, kColors } from "../kit/overlay";
import { runLine } from "../kit/gesture";
import { anchored } from "../kit/naming";
import { fetchSkeleton, pickBranch, selectedTops, type Skeleton, skeletonOf } from "../kit/skeleton";
import { commandLine } from "../kit/words";

/** Deletes the selected branches or nodes; returns false if there is no such selection. */
export function deleteSelected(app: App): boolean {
    const { object, nodes, extent } = app.store.selection.peek();
    const skeleton = object?.kind === "skeleton" ? skeletonOf(app, object.name) : null;
    if (!object || !skeleton || nodes.length === 0) {
        return false;
    }
    const chosen = skeleton.selected(nodes, extent);
    const alone = extent === "node";
    const ids = (alone ? chosen : skeleton.highest(chosen)).map((n) => skeleton.ids[n]);
    app.store.selection.value = { ...app.store.selection.peek(), nodes: [] };
    void anchored(app, object.name, ids).then((selection) =>
        runLine(app, commandLine(["edit", "delete", object.name, selection], { alone: alone || undefined }), object),
    );
    return true;
}

/** The segments of a subtree, as pairs of points. */
export function subtreeSegments(skeleton: Skeleton, n: number): [number, number, number][] {
    return skeleton.subtree(n).flatMap((node) => {
        const parent = skeleton.parent(node);
        return parent < 0 ? [] : [skeleton.at(parent), skeleton.at(node)];
    });
}

export const anySkeleton = (app: App): boolean => app.store.state.peek().objects.some(({ kind }) => kind === "skeleton");

const kStill = 6; // [px] maximum movement of a click

/** One click cuts; hovering shows the segments that would be removed. */
class CutRun implements ToolRun {
    private readonly overlay: Overlay;
    private under: Pick | null = null;
    private pressed: ToolPointer | null = null;

    constructor(
        private readonly app: App,
        private readonly command: "delete" | "detach",
    ) {
        this.overlay = new Overlay(app);
        const { object } = app.store.selection.peek();
        if (object?.kind === "skeleton") {
            void fetchSkeleton(app, object.name);
        }
    }

    stop(): void {
        this.overlay.stop();
    }

    status(): string {
        const effect = this.command === "delete" ? "cut off" : "made a separate tree";
        return this.under?.node === undefined
            ? `Click the branch that is to be ${effect}, or press Enter for the selection.`
            : `The branch from node ${this.under.node} will be ${effect}.`;
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            this.pressed = event;
            void this.aim(event);
            return pickBranch(this.app, event.x, event.y) !== null;
        }
        if (event.phase === "move" && event.buttons === 0) {
            void this.aim(event);
        }
        if (event.phase === "up" && this.pressed && Math.hypot(event.x - this.pressed.x, event.y - this.pressed.y) < kStill) {
            void this.cut(event);
        }
        if (event.phase === "up" || event.phase === "cancel") {
            this.pressed = null;
        }
        return false;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key !== "Enter") {
            return false;
        }
        const chosen = selectedTops(this.app);
        if (chosen) {
            void this.run(chosen.name, chosen.ids);
        }
        return true;
    }

    private async aim(event: ToolPointer): Promise<void> {
        const pick = this.app.view.pick(event.x, event.y, ["skeleton"]);
        if (pick?.object.name === this.under?.object.name && pick?.node === this.under?.node) {
            return;
        }
        this.under = pick;
        this.overlay.clear();
        const skeleton = pick && (await fetchSkeleton(this.app, pick.object.name));
        const n = skeleton && pick?.node !== undefined ? skeleton.index(pick.node) : -1;
        if (skeleton && n >= 0 && this.under === pick) {
            const segments = subtreeSegments(skeleton, n);
            if (segments.length > 0) {
                this.overlay.line(segments, kColors.cut, true);
            }
        }
    }

    private async cut(event: ToolPointer): Promise<void> {
        const pick = this.app.view.pick(event.x, event.y, ["skeleton"]);
        if (pick?.node !== undefined) {
            this.overlay.clear();
            this.under = null;
            await this.run(pick.object.name, [pick.node]);
        }
    }

    private async run(name: string, ids: number[]): Promise<void> {
        const about = { kind: "skeleton" as const, name };
        const selection = await anchored(this.app, name, ids);
        await runLine(this.app, commandLine(["edit", this.command, name, selection]), about);
    }
}

export const cutTools: Tool[] = [
    {
        id: "cut",
        label: "Cut",
        group: "branch",
        shortcut: "X",
        help: "Cuts off the clicked branch with its subtree.",
        enabled: anySkeleton,
        start: (app) => new CutRun(app, "delete"),
    },
    {
        id: "detach",
        label: "Detach",
        group: "branch",
        help: "Makes the clicked branch a separate tree, which can be moved and grafted to another position.",
        enabled: anySkeleton,
        start: (app) => new CutRun(app, "detach"),
    },
];
