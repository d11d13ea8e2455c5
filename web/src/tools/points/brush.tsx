// A ball that removes or adds points, and the roots where growth starts.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, Point } from "../../protocol";
import { Overlay, kColors, sight } from "../kit/overlay";
import { Button, ChoiceField, NumberField, PointField, pointSignals } from "../kit/fields";
import { runLine } from "../kit/gesture";
import { distance, kAxes, onPlane } from "../kit/vector";
import { commandLine, newName, numberWord, pointWord, sizeWord } from "../kit/words";

type Method = "thin" | "densify";

const method = signal<Method>("thin");
const percent = signal(100);
const count = signal(50);

export interface Ball {
    center: Point;
    radius: number;
}

/** A dab is one block: the ball in which points change, the change, and the deletion of the ball. */
export function brushLines(points: string, ball: string, { center, radius }: Ball, method: Method, amount: number, step: number): string {
    const sphere = commandLine(["sphere", ball], { center: pointWord(center, step), radius: sizeWord(radius, step) });
    const change =
        method === "thin"
            ? commandLine(["pointset", "thin", points, ball, numberWord(amount, 0.1)])
            : commandLine(["pointset", "densify", points, ball], { count: Math.round(amount) });
    return ["repeat 1", `  ${sphere}`, `  ${change}`, `  ${commandLine(["delete", ball], { kind: "solid" })}`, "end"].join("\n");
}

class BrushRun implements ToolRun {
    private ball: Ball | null = null;
    private pressed = false;
    private readonly overlay: Overlay;
    private readonly center = pointSignals([0, 0, 0]);
    private readonly radius = signal(0.5);

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        const points = this.chosen();
        const object = points && app.store.find("points", points.name);
        if (object) {
            const [x0, y0, z0, x1, y1, z1] = object.bounds;
            [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2].forEach((value, i) => {
                this.center[i].value = value;
            });
            this.radius.value = Math.max(x1 - x0, y1 - y0, z1 - z0) / 8;
        }
    }

    stop(): void {
        this.overlay.stop();
    }

    status(): string {
        const points = this.chosen();
        const effect = method.value === "thin" ? `removes ${percent.value} % of the points` : `adds ${count.value} points`;
        return points ? `Press on ${points.name} and drag to size a ball, which ${effect}; Enter applies the fields.` : "There are no points yet.";
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            const pick = this.app.view.pick(event.x, event.y, ["points"]);
            if (!pick) {
                return false;
            }
            this.ball = { center: pick.point, radius: 20 * this.app.view.pixelSize(pick.point) };
            this.pressed = true;
            this.app.store.selection.value = { ...this.app.store.selection.peek(), object: pick.object, nodes: [] };
            this.draw();
            return true;
        }
        if (!this.pressed || !this.ball) {
            return false;
        }
        if (event.phase === "cancel") {
            this.reset();
        } else if (event.phase === "up") {
            void this.dab(this.ball);
            this.reset();
        } else {
            const to = this.app.view.toPlane(event.x, event.y, this.ball.center);
            const least = 6 * this.app.view.pixelSize(this.ball.center);
            this.ball = to ? { ...this.ball, radius: Math.max(distance(to, this.ball.center), least) } : this.ball;
            this.draw();
        }
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Enter") {
            this.byFields();
            return true;
        }
        if (event.key === "Escape" && this.pressed) {
            this.reset();
            return true;
        }
        return false;
    }

    panel(): VNode {
        const methods = [
            ["thin", "removes points"],
            ["densify", "adds points"],
        ] as const;
        return (
            <>
                <ChoiceField label="The ball" value={method} choices={methods} />
                {method.value === "thin" ? (
                    <NumberField label="Percentage to remove" unit="%" value={percent} low={0} high={100} />
                ) : (
                    <NumberField label="How many" value={count} low={1} step={1} />
                )}
                <PointField label="Middle" value={this.center} />
                <NumberField label="Radius" unit="m" value={this.radius} low={1e-4} />
                <Button label="Apply there" run={() => this.byFields()} />
            </>
        );
    }

    private chosen(): ObjectName | null {
        const { object } = this.app.store.selection.peek();
        const first = this.app.store.state.peek().objects.find(({ kind }) => kind === "points");
        return object?.kind === "points" ? object : first ? { kind: "points", name: first.name } : null;
    }

    private byFields(): void {
        void this.dab({ center: this.center.map((value) => value.peek()) as Point, radius: this.radius.peek() });
    }

    private async dab(ball: Ball): Promise<void> {
        const points = this.chosen();
        if (points) {
            const amount = method.peek() === "thin" ? percent.peek() : count.peek();
            const step = this.app.view.pixelSize(ball.center) / 10;
            await runLine(this.app, brushLines(points.name, newName("dab"), ball, method.peek(), amount, step), points);
        }
    }

    private draw(): void {
        this.overlay.clear();
        if (this.ball) {
            const { center, radius } = this.ball;
            const color = method.peek() === "thin" ? kColors.cut : kColors.grow;
            for (const axis of [sight(this.app, center), kAxes.z, kAxes.x]) {
                this.overlay.circle(center, axis, radius, color);
            }
        }
    }

    private reset(): void {
        this.pressed = false;
        this.ball = null;
        this.overlay.clear();
    }
}

class RootRun implements ToolRun {
    private readonly overlay: Overlay;
    private readonly at = pointSignals([0, 0, 0]);
    private readonly points = signal("");
    private readonly name = signal("");

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.name.value = app.store.freeName("tree");
        const { object } = app.store.selection.peek();
        this.points.value = object?.kind === "points" ? object.name : (this.names()[0] ?? "");
    }

    stop(): void {
        this.overlay.stop();
    }

    status(): string {
        return "Click the position of the tree; Enter grows it.";
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase !== "down" || event.buttons !== 1) {
            return false;
        }
        const { view } = this.app;
        const ground = onPlane(view.ray(event.x, event.y), [0, 0, 0], kAxes.z);
        const onViewPlane = () => view.toPlane(event.x, event.y, this.at.map((value) => value.peek()) as Point); // the ground is seen edge-on
        const at = view.pick(event.x, event.y, ["solid", "mesh"])?.point ?? ground ?? onViewPlane();
        if (at) {
            at.forEach((value, i) => {
                this.at[i].value = Number(numberWord(value, view.pixelSize(at) / 10));
            });
            this.overlay.clear();
            this.overlay.dots([at], kColors.grow, 13);
        }
        return at !== null;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Enter") {
            void this.grow();
            return true;
        }
        return false;
    }

    panel(): VNode {
        return (
            <>
                <ChoiceField label="Grows into" value={this.points} choices={this.names().map((name) => [name, name] as const)} />
                <PointField label="Root" value={this.at} />
                <Button label="Grow" run={() => void this.grow()} />
            </>
        );
    }

    private names(): string[] {
        return this.app.store.state
            .peek()
            .objects.filter(({ kind }) => kind === "points")
            .map(({ name }) => name);
    }

    private async grow(): Promise<void> {
        const name = this.name.peek();
        const root = pointWord(this.at.map((value) => value.peek()));
        const points = this.points.peek();
        const ran = await runLine(this.app, commandLine(["grow", newName(name), points], { root }));
        if (ran) {
            this.app.store.selection.value = {
                ...this.app.store.selection.peek(),
                object: { kind: "skeleton", name: ran.names[0] ?? name },
                nodes: [],
            };
            this.app.take("select");
        }
    }
}

const anyPoints = (app: App) => app.store.state.peek().objects.some(({ kind }) => kind === "points");

export const pointTools: Tool[] = [
    {
        id: "points",
        label: "Brush",
        group: "points",
        help: "Removes points in a ball, or adds some: press on the points and drag to size it.",
        enabled: anyPoints,
        start: (app) => new BrushRun(app),
    },
    {
        id: "root",
        label: "Root",
        group: "points",
        help: "Places the root of a tree by a click, and grows it into points.",
        enabled: anyPoints,
        start: (app) => new RootRun(app),
    },
];
