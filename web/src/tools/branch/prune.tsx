// A brush that cuts off the tips it touches; one line at the end of the stroke.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName } from "../../protocol";
import { Overlay, kColors } from "../kit/overlay";
import { Button, NumberField } from "../kit/fields";
import { Gesture, runLine } from "../kit/gesture";
import { anchored } from "../kit/naming";
import { followSkeletons, pickBranch, type Skeleton, skeletonOf } from "../kit/skeleton";
import { toSegment } from "../kit/vector";
import { commandLine, idSelection, sizeWord } from "../kit/words";
import { anySkeleton, subtreeSegments } from "./cut";

const brush = signal(24); // [px]
const shorter = signal(0.1); // [m]

/** The painted nodes that are removed: tips, and nodes without remaining children. Parents come before children. */
export function prunable(skeleton: Skeleton, painted: ReadonlySet<number>): number[] {
    const isRemoved = new Uint8Array(skeleton.size);
    for (let n = skeleton.size - 1; n >= 0; --n) {
        isRemoved[n] = painted.has(n) && skeleton.children[n].every((child) => isRemoved[child] === 1) ? 1 : 0;
    }
    return skeleton.all().filter((n) => isRemoved[n] === 1 && (skeleton.parent(n) < 0 || isRemoved[skeleton.parent(n)] === 0));
}

/** Positions of the brush on its path, close enough to cover it without gaps. */
export function brushed(from: readonly [number, number], to: readonly [number, number], radius: number): [number, number][] {
    const steps = Math.max(Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / radius), 1);
    return Array.from({ length: steps }, (_, i) => {
        const share = (i + 1) / steps;
        return [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
    });
}

/** The nodes with segments that the brush touches at a position of the view. */
export function touched(skeleton: Skeleton, pixels: readonly (readonly number[])[], x: number, y: number, radius: number): number[] {
    return skeleton.all().filter((n) => {
        const parent = skeleton.parent(n);
        // Only the half towards the node counts, so that a brush over a fork does not remove a complete branch.
        const from = parent < 0 ? pixels[n] : [0, 1].map((k) => (pixels[parent][k] + pixels[n][k]) / 2);
        return Math.abs(pixels[n][2]) <= 1 && toSegment(x, y, from, pixels[n]).far <= radius;
    });
}

function pruneLine(about: ObjectName, selection: string): string {
    return commandLine(["edit", "delete", about.name, selection]);
}

class PruneRun implements ToolRun {
    private readonly painted = new Set<number>();
    private about: ObjectName | null = null;
    private skeleton: Skeleton | null = null;
    private pixels: [number, number, number][] = [];
    private gesture: Gesture | null = null;
    private last: [number, number] | null = null; // of the brush, while it paints
    private readonly overlay: Overlay;
    private readonly unfollow: () => void;
    private readonly ring = document.createElement("div");

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.ring.className = "tool-brush";
        this.ring.hidden = true;
        app.view.element().parentElement?.append(this.ring);
        this.unfollow = followSkeletons(app);
    }

    stop(): void {
        this.gesture?.cancel();
        this.unfollow();
        this.overlay.stop();
        this.ring.remove();
    }

    status(): string {
        return this.gesture?.refusal || "Paint over tips to cut them off; Ctrl and the wheel, or [ and ], make the brush larger or smaller.";
    }

    pointer(event: ToolPointer): boolean {
        this.follow(event);
        if (event.phase === "down" && event.buttons === 1) {
            return this.begin(event);
        }
        if (!this.last) {
            return false;
        }
        if (event.phase === "cancel") {
            this.reset();
        } else if (event.phase === "up") {
            void this.end();
        } else {
            this.paint(event);
        }
        return true;
    }

    wheel(delta: number, event: ToolPointer): boolean {
        if (!event.control && !this.last) {
            return false;
        }
        brush.value = Math.min(Math.max(brush.peek() * Math.exp(-delta / 800), 4), 200);
        this.follow(event);
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "[" || event.key === "]") {
            brush.value = Math.min(Math.max(brush.peek() * (event.key === "]" ? 1.2 : 1 / 1.2), 4), 200);
            return true;
        }
        if (event.key === "Escape" && this.last) {
            this.reset();
            return true;
        }
        return false;
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Brush" unit="px" value={brush} low={4} high={200} />
                <NumberField label="Branches shorter than" unit="m" value={shorter} low={0} />
                <Button label="Cut off shorter branches" run={() => this.byLength()} />
            </>
        );
    }

    private byLength(): void {
        const object = this.chosen();
        if (object) {
            void runLine(this.app, commandLine(["edit", "prune", object.name], { length: sizeWord(shorter.peek()) }), object);
        }
    }

    private chosen(): ObjectName | null {
        const { object } = this.app.store.selection.peek();
        if (object?.kind === "skeleton") {
            return object;
        }
        const hidden = this.app.store.hidden.peek();
        const first = this.app.store.state.peek().objects.find(({ kind, name }) => kind === "skeleton" && !hidden.has(`skeleton:${name}`));
        return first ? { kind: "skeleton", name: first.name } : null;
    }

    private follow(event: ToolPointer): void {
        const { style } = this.ring;
        this.ring.hidden = event.type === "touch" && event.phase === "up";
        style.left = `${event.x - brush.peek()}px`;
        style.top = `${event.y - brush.peek()}px`;
        style.width = `${2 * brush.peek()}px`;
        style.height = `${2 * brush.peek()}px`;
    }

    private begin(event: ToolPointer): boolean {
        const pick = pickBranch(this.app, event.x, event.y);
        this.about = pick?.object ?? this.chosen();
        this.skeleton = this.about && skeletonOf(this.app, this.about.name);
        if (!this.about || !this.skeleton) {
            return false;
        }
        const { skeleton } = this;
        this.pixels = skeleton.all().map((n) => this.app.view.toPixels(skeleton.at(n)));
        this.last = [event.x, event.y];
        this.paint(event);
        return true;
    }

    private paint(event: ToolPointer): void {
        if (!this.skeleton || !this.about || !this.last) {
            return;
        }
        const { skeleton } = this;
        for (const [x, y] of brushed(this.last, [event.x, event.y], brush.peek())) {
            touched(skeleton, this.pixels, x, y, brush.peek()).forEach((n) => this.painted.add(n));
        }
        this.last = [event.x, event.y];
        const tops = prunable(skeleton, this.painted);
        if (tops.length > 0) {
            this.gesture ??= new Gesture(this.app, this.about);
            this.gesture.preview(pruneLine(this.about, idSelection(tops.map((n) => skeleton.ids[n]))));
            this.overlay.clear();
            this.overlay.line(
                tops.flatMap((n) => subtreeSegments(skeleton, n)),
                kColors.cut,
                true,
            );
        }
    }

    private async end(): Promise<void> {
        const { skeleton, gesture, about } = this;
        const ids = skeleton ? prunable(skeleton, this.painted).map((n) => skeleton.ids[n]) : [];
        this.gesture = null;
        this.reset(); // the user may begin again before the line has run
        if (gesture && about && ids.length > 0) {
            await gesture.run(pruneLine(about, await anchored(this.app, about.name, ids)));
        }
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.last = null;
        this.painted.clear();
        this.overlay.clear();
    }
}

export const pruneTools: Tool[] = [
    {
        id: "prune",
        label: "Prune",
        group: "branch",
        shortcut: "P",
        help: "Cuts off the painted tips; Ctrl and the wheel, or [ and ], change the size of the brush.",
        enabled: anySkeleton,
        start: (app) => new PruneRun(app),
    },
];
