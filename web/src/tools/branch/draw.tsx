// Draws a branch on the screen: it begins on the axis under the start of the stroke.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Overlay, kColors } from "../kit/overlay";
import { Button, NumberField, PointField, pointSignals } from "../kit/fields";
import { Gesture, runLine } from "../kit/gesture";
import { fetchSkeleton, followSkeletons, type Skeleton, skeletonOf } from "../kit/skeleton";
import { onPlane } from "../kit/vector";
import { commandLine, newName, pointWord, sizeWord } from "../kit/words";
import { placeOnSegment } from "./bend";
import { drawnBranch, type Pixel } from "./stroke";

const kNear = 24; // [px] maximum distance from an axis at which a stroke begins on it

const radius = signal(0);
const tipRadius = signal(0);

/** The command for a branch through points: on an existing tree, or as a new stem. */
export function drawLine(about: ObjectName | null, name: string, points: readonly Point[], step: number, radii: { first: number; last: number }): string {
    const words = points.map((point) => pointWord(point, step));
    const options = {
        radius: radii.first > 0 ? sizeWord(radii.first, step) : undefined,
        tip_radius: radii.last > 0 ? sizeWord(radii.last, step) : undefined,
    };
    return about ? commandLine(["edit", "draw", about.name, ...words], options) : commandLine(["limb", name, ...words], options);
}

/** A drawn stroke, from press to release. */
interface Stroke {
    pixels: Pixel[];
    pressure: number; // of a pen; 0: not available
    start: Point | null; // null until the start has been found
    about: ObjectName | null; // the skeleton on which it begins
    skeleton: Skeleton | null;
    rooted: Promise<void>; // resolves when `start` is known
}

class DrawRun implements ToolRun {
    private stroke: Stroke | null = null; // current stroke
    private gesture: Gesture | null = null;
    private readonly overlay: Overlay;
    private readonly unfollow: () => void;
    private readonly from = pointSignals([0, 0, 0]);
    private readonly to = pointSignals([0, 0, 1]);

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.unfollow = followSkeletons(app);
        this.fromSelection();
    }

    stop(): void {
        this.gesture?.cancel();
        this.unfollow();
        this.overlay.stop();
    }

    status(): string {
        return (
            this.gesture?.refusal ||
            (this.stroke
                ? "Release to end the branch; Esc discards it; the wheel changes its radius."
                : "Draw a branch from an axis outward; away from all trees it becomes a separate stem.")
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            this.begin(event);
            return true;
        }
        if (!this.stroke) {
            return false;
        }
        if (event.phase === "cancel") {
            this.reset();
        } else if (event.phase === "up") {
            this.extend(this.stroke, event); // slow pages receive few move events
            void this.end(this.stroke);
        } else if (event.buttons === 1) {
            this.extend(this.stroke, event);
        }
        return true;
    }

    wheel(delta: number): boolean {
        if (!this.stroke?.start) {
            return false;
        }
        const least = this.app.view.pixelSize(this.stroke.start) / 2;
        radius.value = Math.max((radius.peek() || 10 * least) * Math.exp(-delta / 800), least);
        this.show(this.stroke);
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Escape" && this.stroke) {
            this.reset();
            return true;
        }
        return false;
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Radius at its start, 0 = half that of its parent" unit="m" value={radius} low={0} />
                <NumberField label="Radius at its tip, 0 = a quarter" unit="m" value={tipRadius} low={0} />
                <PointField label="From" value={this.from} />
                <PointField label="To" value={this.to} />
                <Button label="Draw it" run={() => void this.straight()} />
            </>
        );
    }

    /** The typed equivalent: a straight branch between two points. */
    private async straight(): Promise<void> {
        const [from, to] = [this.from, this.to].map((part) => part.map((value) => value.peek()) as unknown as Point);
        const { object } = this.app.store.selection.peek();
        const about = object?.kind === "skeleton" ? object : null;
        await runLine(this.app, drawLine(about, newName("tree"), [from, to], 1e-4, { first: radius.peek(), last: tipRadius.peek() }), about ?? undefined);
    }

    private fromSelection(): void {
        const { object, nodes } = this.app.store.selection.peek();
        const skeleton = object?.kind === "skeleton" ? skeletonOf(this.app, object.name) : null;
        const n = skeleton?.index(nodes[0] ?? -1) ?? -1;
        if (skeleton && n >= 0) {
            const at = skeleton.at(n);
            const far = 20 * skeleton.radius[n];
            [0, 1, 2].forEach((i) => {
                this.from[i].value = at[i];
                this.to[i].value = at[i] + (i === 2 ? far : i === 0 ? far : 0);
            });
        }
    }

    private begin(event: ToolPointer): void {
        this.reset();
        const pressure = event.type === "pen" ? event.pressure : 0;
        const stroke: Stroke = { pixels: [[event.x, event.y]], pressure, start: null, about: null, skeleton: null, rooted: Promise.resolve() };
        this.stroke = stroke;
        stroke.rooted = this.root(stroke, event);
    }

    // A branch that begins on a tree with axes that are still loading must not become a separate stem.
    private async root(stroke: Stroke, event: ToolPointer): Promise<void> {
        const names = this.skeletonNames();
        if (!names.every((name) => skeletonOf(this.app, name))) {
            await Promise.all(names.map((name) => fetchSkeleton(this.app, name)));
        }
        const found = this.host(event);
        stroke.about = found?.about ?? null;
        stroke.skeleton = found?.skeleton ?? null;
        stroke.start = found?.start ?? this.open(event);
        this.show(stroke);
    }

    private skeletonNames(): string[] {
        const { objects } = this.app.store.state.peek();
        return objects.filter(({ kind }) => kind === "skeleton").map(({ name }) => name);
    }

    /** The axis under the pointer, or a close one in the view. */
    private host(event: ToolPointer): { about: ObjectName; skeleton: Skeleton; start: Point } | null {
        const { view } = this.app;
        const pick = view.pick(event.x, event.y, ["skeleton"]);
        for (const name of pick ? [pick.object.name] : this.skeletonNames()) {
            const skeleton = skeletonOf(this.app, name);
            const found = skeleton?.nearest(event.x, event.y, (point) => view.toPixels(point), pick ? Infinity : kNear);
            const n = pick?.node !== undefined ? (skeleton?.index(pick.node) ?? -1) : (found?.node ?? -1);
            if (skeleton && found && n >= 0) {
                const share = n === found.node ? found.share : 1;
                return { about: { kind: "skeleton", name }, skeleton, start: placeOnSegment(skeleton, n, share) };
            }
        }
        return null;
    }

    /** The start of a stem without a tree under it: on the object there, or on the ground. */
    private open(event: ToolPointer): Point {
        const { view } = this.app;
        return (
            view.pick(event.x, event.y)?.point ??
            onPlane(view.ray(event.x, event.y), [0, 0, 0], [0, 0, 1]) ??
            view.toPlane(event.x, event.y, [0, 0, 0]) ?? [0, 0, 0]
        );
    }

    private extend(stroke: Stroke, event: ToolPointer): void {
        const last = stroke.pixels[stroke.pixels.length - 1];
        if (Math.hypot(event.x - last[0], event.y - last[1]) >= 3) {
            stroke.pixels.push([event.x, event.y]);
            this.show(stroke);
        }
    }

    private line(stroke: Stroke): { line: string; points: Point[] } | null {
        const { view } = this.app;
        const { start, skeleton, about } = stroke;
        const points = start && drawnBranch(stroke.pixels, start, skeleton, view);
        if (!points || !start) {
            return null;
        }
        const step = view.pixelSize(start) / 10;
        // The pressure of a pen scales the default radius.
        const pressed = stroke.pressure > 0 && radius.peek() === 0 ? this.hostRadius(stroke) * stroke.pressure : 0;
        const own = pressed || radius.peek();
        const first = !about && own === 0 ? 6 * view.pixelSize(start) : own;
        return { line: drawLine(about, newName("tree"), points, step, { first, last: tipRadius.peek() }), points };
    }

    private hostRadius({ skeleton, pixels }: Stroke): number {
        const [x, y] = pixels[0];
        const found = skeleton?.nearest(x, y, (point) => this.app.view.toPixels(point));
        return found && skeleton ? skeleton.radius[found.node] : 0;
    }

    // A finished stroke that waits for its start is no longer shown.
    private show(stroke: Stroke): void {
        const result = stroke === this.stroke ? this.line(stroke) : null;
        if (result) {
            this.overlay.clear();
            this.overlay.line(result.points, kColors.grow);
            this.gesture ??= new Gesture(this.app, stroke.about ?? undefined);
            this.gesture.preview(result.line);
        }
    }

    // A finished stroke becomes a branch, even if the user has continued with another action.
    private async end(stroke: Stroke): Promise<void> {
        const { gesture } = this;
        this.gesture = null;
        this.reset();
        await stroke.rooted;
        const result = this.line(stroke);
        if (result) {
            await (gesture ?? new Gesture(this.app, stroke.about ?? undefined)).run(result.line);
        } else {
            gesture?.cancel();
        }
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.stroke = null;
        this.overlay.clear();
    }
}

export const drawTools: Tool[] = [
    {
        id: "draw",
        label: "Draw",
        group: "branch",
        shortcut: "D",
        help: "Draws a branch on the screen, from the axis under the start of the stroke; its depth is that of the surrounding branches.",
        start: (app) => new DrawRun(app),
    },
];
