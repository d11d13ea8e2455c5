// Drawing a branch on the screen: it begins on the axis under the stroke's start.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Drawn, kColors } from "../kit/drawn";
import { Button, NumberField, PointField, pointSignals } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { fetchSkeleton, followSkeletons, type Skeleton, skeletonOf } from "../kit/skeleton";
import { onPlane } from "../kit/vector";
import { commandLine, pointWord, sizeWord } from "../kit/words";
import { placeOnSegment } from "./bend";
import { drawnBranch, type Pixel } from "./stroke";

const kNear = 24; // [px] from an axis where a stroke still begins on it

const radius = signal(0);
const tipRadius = signal(0);

/** The command of a branch through points: of a tree that is there, or a stem of its own. */
export function drawLine(
    about: ObjectName | null,
    name: string,
    points: readonly Point[],
    step: number,
    radii: { first: number; last: number },
): string {
    const words = points.map((point) => pointWord(point, step));
    const options = {
        radius: radii.first > 0 ? sizeWord(radii.first, step) : undefined,
        tip_radius: radii.last > 0 ? sizeWord(radii.last, step) : undefined,
    };
    return about ? commandLine(["edit", "draw", about.name, ...words], options) : commandLine(["limb", name, ...words], options);
}

class DrawRun implements ToolRun {
    private stroke: Pixel[] = [];
    private rooted: Promise<void> = Promise.resolve(); // when it is known where the stroke begins
    private start: Point | null = null;
    private about: ObjectName | null = null;
    private skeleton: Skeleton | null = null;
    private gesture: Gesture | null = null;
    private pressure = 0;
    private readonly drawn: Drawn;
    private readonly unfollow: () => void;
    private readonly from = pointSignals([0, 0, 0]);
    private readonly to = pointSignals([0, 0, 1]);

    constructor(private readonly app: App) {
        this.drawn = new Drawn(app);
        this.unfollow = followSkeletons(app);
        this.fromSelection();
    }

    stop(): void {
        this.gesture?.cancel();
        this.unfollow();
        this.drawn.stop();
    }

    status(): string {
        return (
            this.gesture?.refusal ||
            (this.stroke.length > 0
                ? "Release to end the branch; Esc takes it back; the wheel changes its radius."
                : "Draw a branch, from an axis outward; beside all trees it becomes a stem of its own.")
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            this.begin(event);
            return true;
        }
        if (this.stroke.length === 0) {
            return false;
        }
        if (event.phase === "cancel") {
            this.reset();
        } else if (event.phase === "up") {
            void this.end();
        } else if (event.buttons === 1) {
            this.extend(event);
        }
        return true;
    }

    wheel(delta: number): boolean {
        if (!this.start) {
            return false;
        }
        const least = this.app.view.pixelSize(this.start) / 2;
        radius.value = Math.max((radius.peek() || 10 * least) * Math.exp(-delta / 800), least);
        this.show();
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Escape" && this.stroke.length > 0) {
            this.reset();
            return true;
        }
        return false;
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Radius at its start, 0 = half its host's" unit="m" value={radius} low={0} />
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
        await this.run(about, drawLine(about, this.app.store.freeName("tree"), [from, to], 1e-4, this.radii()));
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
        this.stroke = [[event.x, event.y]];
        this.pressure = event.type === "pen" ? event.pressure : 0;
        this.rooted = this.root(event);
    }

    // A branch that begins on a tree whose axes are still on their way must not become a stem of its own.
    private async root(event: ToolPointer): Promise<void> {
        const { stroke } = this;
        const names = this.skeletonNames();
        if (!names.every((name) => skeletonOf(this.app, name))) {
            await Promise.all(names.map((name) => fetchSkeleton(this.app, name)));
        }
        if (stroke === this.stroke) {
            const found = this.host(event);
            this.about = found?.about ?? null;
            this.skeleton = found?.skeleton ?? null;
            this.start = found?.start ?? this.open(event);
            this.show();
        }
    }

    private skeletonNames(): string[] {
        const { objects } = this.app.store.state.peek();
        return objects.filter(({ kind }) => kind === "skeleton").map(({ name }) => name);
    }

    /** The axis under the pointer, or one that is near in the picture. */
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

    /** Where a stem begins that has no tree under it: on what lies there, or on the ground. */
    private open(event: ToolPointer): Point {
        const { view } = this.app;
        return (
            view.pick(event.x, event.y)?.point ??
            onPlane(view.ray(event.x, event.y), [0, 0, 0], [0, 0, 1]) ??
            view.toPlane(event.x, event.y, [0, 0, 0]) ?? [0, 0, 0]
        );
    }

    private extend(event: ToolPointer): void {
        const last = this.stroke[this.stroke.length - 1];
        if (Math.hypot(event.x - last[0], event.y - last[1]) >= 3) {
            this.stroke.push([event.x, event.y]);
            this.show();
        }
    }

    private radii(): { first: number; last: number } {
        // A pen's pressure makes the branch thicker or thinner than it would be.
        const host = this.skeleton && this.pressure > 0 && radius.peek() === 0 ? this.nearRadius() * this.pressure : 0;
        return { first: host || radius.peek(), last: tipRadius.peek() };
    }

    private nearRadius(): number {
        const [x, y] = this.stroke[0];
        const found = this.skeleton?.nearest(x, y, (point) => this.app.view.toPixels(point));
        return found && this.skeleton ? this.skeleton.radius[found.node] : 0;
    }

    private line(): { line: string; points: Point[] } | null {
        const { view } = this.app;
        const points = this.start && drawnBranch(this.stroke, this.start, this.skeleton, view);
        if (!points || !this.start) {
            return null;
        }
        const step = view.pixelSize(this.start) / 10;
        const radii = this.radii();
        const first = !this.about && radii.first === 0 ? 6 * view.pixelSize(this.start) : radii.first;
        return { line: drawLine(this.about, this.app.store.freeName("tree"), points, step, { ...radii, first }), points };
    }

    private show(): void {
        const made = this.line();
        this.drawn.clear();
        if (made) {
            this.drawn.line(made.points, kColors.grow);
            this.gesture ??= new Gesture(this.app, this.about ?? undefined);
            this.gesture.preview(made.line);
        }
    }

    private async end(): Promise<void> {
        const { stroke } = this;
        await this.rooted;
        if (stroke !== this.stroke) {
            return;
        }
        const made = this.line();
        const { about, gesture } = this;
        this.gesture = null;
        this.reset();
        if (made) {
            await this.run(about, made.line, gesture);
        }
    }

    private async run(about: ObjectName | null, line: string, gesture?: Gesture | null): Promise<void> {
        await (gesture ?? new Gesture(this.app, about ?? undefined)).run(line);
    }

    private reset(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.stroke = [];
        this.start = null;
        this.drawn.clear();
    }
}

export const drawTools: Tool[] = [
    {
        id: "draw",
        label: "Draw",
        group: "branch",
        shortcut: "D",
        help: "Draws a branch on the screen, from the axis under the stroke's start; its depth is that of the branches around.",
        start: (app) => new DrawRun(app),
    },
];
