// Cutting and detaching: of what is selected by keys, or of what is clicked.
import type { App, Pick, Tool, ToolPointer, ToolRun } from "../../app";
import { Drawn, kColors } from "../kit/drawn";
import { runLine } from "../kit/gesture";
import { anchored } from "../kit/naming";
import { fetchSkeleton, pickBranch, selectedTops, type Skeleton, skeletonOf } from "../kit/skeleton";
import { commandLine } from "../kit/words";

/** Deletes the branches or nodes that are selected; false where none are. */
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

/** The segments of a branch and all on it, as pairs of points. */
export function subtreeSegments(skeleton: Skeleton, n: number): [number, number, number][] {
    return skeleton.subtree(n).flatMap((node) => {
        const parent = skeleton.parent(node);
        return parent < 0 ? [] : [skeleton.at(parent), skeleton.at(node)];
    });
}

export const anySkeleton = (app: App): boolean => app.store.state.peek().objects.some(({ kind }) => kind === "skeleton");

const kStill = 6; // [px]

/** One click does it; hovering shows what would go. */
class CutRun implements ToolRun {
    private readonly drawn: Drawn;
    private under: Pick | null = null;
    private pressed: ToolPointer | null = null;

    constructor(
        private readonly app: App,
        private readonly command: "delete" | "detach",
    ) {
        this.drawn = new Drawn(app);
        const { object } = app.store.selection.peek();
        if (object?.kind === "skeleton") {
            void fetchSkeleton(app, object.name);
        }
    }

    stop(): void {
        this.drawn.stop();
    }

    status(): string {
        const what = this.command === "delete" ? "cut off" : "made a tree of its own";
        return this.under?.node === undefined
            ? `Click the branch that is to be ${what}, or press Enter for what is selected.`
            : `The branch from node ${this.under.node} on will be ${what}.`;
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
        this.drawn.clear();
        const skeleton = pick && (await fetchSkeleton(this.app, pick.object.name));
        const n = skeleton && pick?.node !== undefined ? skeleton.index(pick.node) : -1;
        if (skeleton && n >= 0 && this.under === pick) {
            const segments = subtreeSegments(skeleton, n);
            if (segments.length > 0) {
                this.drawn.line(segments, kColors.cut, true);
            }
        }
    }

    private async cut(event: ToolPointer): Promise<void> {
        const pick = this.app.view.pick(event.x, event.y, ["skeleton"]);
        if (pick?.node !== undefined) {
            this.drawn.clear();
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
        help: "Cuts off the branch that is clicked, with all that hangs on it.",
        enabled: anySkeleton,
        start: (app) => new CutRun(app, "delete"),
    },
    {
        id: "detach",
        label: "Detach",
        group: "branch",
        help: "Makes the branch that is clicked a tree of its own, which can be moved away and grafted elsewhere.",
        enabled: anySkeleton,
        start: (app) => new CutRun(app, "detach"),
    },
];
