// Bends a branch by its tip, and moves a node together with its axis.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { Tool } from "../../app";
import type { Point } from "../../protocol";
import { BranchDragRun, type Held } from "../kit/branch_drag";
import { sight } from "../kit/overlay";
import { AxisButtons, Button, NumberField, PointField, pointSignals } from "../kit/fields";
import type { NodeLine } from "../kit/naming";
import type { Skeleton } from "../kit/skeleton";
import { typedShift } from "../kit/typed_input";
import { add, kAxes, length, mix } from "../kit/vector";
import { commandLine, directionWord, numberWord, pointWord, sizeWord } from "../kit/words";
import { type Bend, bendTo, leverOf } from "./bend_angle";
import { anySkeleton } from "./cut";

class BendRun extends BranchDragRun {
    private grabbed = -1; // the node under the pointer; its branch is bent
    private readonly angle = signal(0);

    protected override grip(skeleton: Skeleton, n: number): number {
        this.grabbed = n;
        return skeleton.axisStart(n);
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Angle" unit="°" value={this.angle} changed={() => this.type(String(this.angle.peek()))} />
                <AxisButtons
                    choose={(axis) => {
                        this.typed.axis = axis;
                        this.show();
                    }}
                />
                <Button label="Apply" run={() => this.end()} />
            </>
        );
    }

    protected nodeLine(held: Held): NodeLine | null {
        const bend = this.bend(held);
        if (!bend || Math.abs(bend.degrees) < 0.05) {
            return null;
        }
        const options = { towards: directionWord(bend.towards) };
        return {
            name: held.about.name,
            nodes: [held.ids],
            line: ([nodes]) => commandLine(["edit", "bend", held.about.name, nodes, numberWord(bend.degrees, 0.05)], options),
        };
    }

    protected text(held: Held | null): string {
        if (!held) {
            return "Drag a branch to its new direction, or select one and type degrees.";
        }
        const bend = this.bend(held);
        const by = bend ? ` by ${numberWord(bend.degrees, 0.1)}° towards ${directionWord(bend.towards)}` : "";
        return `Bends the branch of node ${held.skeleton.ids[held.n]}${by}. Type degrees, X, Y or Z for the direction; Enter ends.`;
    }

    protected override draw(): void {
        this.overlay.clear();
        if (this.held) {
            const { chain, lever } = this.lever(this.held);
            this.overlay.dots([add(chain[lever], this.shift(chain[lever]))]);
        }
    }

    protected override show(): void {
        super.show();
        const bend = this.held && this.bend(this.held);
        this.angle.value = bend ? Number(numberWord(bend.degrees, 0.05)) : 0;
    }

    protected override clear(): void {
        this.angle.value = 0;
    }

    /** The axis from its joint, and the dragged position on it. */
    private lever({ skeleton, n }: Held): { chain: Point[]; lever: number } {
        const chain = chainOf(skeleton, n);
        const nodes = skeleton.axis(n);
        const at = nodes.indexOf(this.grabbed);
        return { chain, lever: at < 0 ? chain.length - 1 : leverOf(chain, at + chain.length - nodes.length) };
    }

    private bend(held: Held): Bend | null {
        const angle = this.typed.values()?.[0];
        const { chain, lever } = this.lever(held);
        const by = this.shift(chain[lever]);
        if (angle !== undefined) {
            const towards: Point = this.typed.axis ? kAxes[this.typed.axis] : length(by) > 0 ? by : [0, 0, -1];
            return { degrees: angle, towards };
        }
        return length(by) === 0 || chain.length < 3 ? null : bendTo(chain, add(chain[lever], by), lever);
    }
}

/** The points of an axis, starting at its joint with the parent. */
export function chainOf(skeleton: Skeleton, n: number): Point[] {
    const start = skeleton.axisStart(n);
    const parent = skeleton.parent(start);
    const points = skeleton.axis(n).map((node) => skeleton.at(node));
    return parent < 0 ? points : [skeleton.at(parent), ...points];
}

const reach = signal(0);

class ReshapeRun extends BranchDragRun {
    private readonly by = pointSignals([0, 0, 0]);

    wheel(delta: number): boolean {
        if (!this.held) {
            return false;
        }
        const least = 5 * this.app.view.pixelSize(this.held.skeleton.at(this.held.n));
        const next = (reach.peek() > 0 ? reach.peek() : 20 * least) * Math.exp(-delta / 500);
        reach.value = next < least ? 0 : next;
        this.show();
        return true;
    }

    panel(): VNode {
        const typed = () => this.type(this.by.map((value) => String(value.peek())).join(","));
        return (
            <>
                <PointField label="By" value={this.by} changed={typed} />
                <NumberField label="Reach, 0 = whole axis" unit="m" value={reach} low={0} changed={() => this.show()} />
                <Button label="Apply" run={() => this.end()} />
            </>
        );
    }

    protected override show(): void {
        super.show();
        if (this.held) {
            const at = this.held.skeleton.at(this.held.n);
            this.fill(typedShift(this.typed) ?? this.shift(at), this.step(at));
        }
    }

    protected override clear(): void {
        this.fill([0, 0, 0], 1);
    }

    private fill(by: Point, step: number): void {
        by.forEach((value, i) => {
            this.by[i].value = Number(numberWord(value, step));
        });
    }

    protected nodeLine(held: Held): NodeLine | null {
        const at = held.skeleton.at(held.n);
        const by = typedShift(this.typed) ?? this.shift(at);
        if (length(by) === 0) {
            return null;
        }
        const step = this.step(at);
        const options = { by: pointWord(by, step), reach: reach.peek() > 0 ? sizeWord(reach.peek(), step) : undefined };
        return {
            name: held.about.name,
            nodes: [[held.skeleton.ids[held.n]]],
            line: ([node]) => commandLine(["edit", "move", held.about.name, node], options),
        };
    }

    protected text(held: Held | null): string {
        const far = reach.value > 0 ? `${numberWord(reach.value, 0.001)} m along it` : "all of it";
        return held
            ? `Moves node ${held.skeleton.ids[held.n]}; ${far} of its axis follows. The wheel changes the length; type x,y,z; Enter ends.`
            : "Drag a node to move it; its axis follows.";
    }

    protected override draw(): void {
        this.overlay.clear();
        if (!this.held) {
            return;
        }
        const { skeleton, n } = this.held;
        const at = add(skeleton.at(n), typedShift(this.typed) ?? this.shift(skeleton.at(n)));
        this.overlay.dots([at]);
        if (reach.peek() > 0) {
            this.overlay.circle(at, sight(this.app, at), reach.peek());
        }
    }
}

/** The point at a fraction of the segment of node n. */
export function placeOnSegment(skeleton: Skeleton, n: number, share: number): Point {
    const parent = skeleton.parent(n);
    return parent < 0 ? skeleton.at(n) : mix(skeleton.at(parent), skeleton.at(n), share);
}

export const bendTools: Tool[] = [
    {
        id: "bend",
        label: "Bend",
        group: "branch",
        shortcut: "C",
        help: "Bends a branch: drag a point of it to its new position, or type degrees and X, Y or Z for the direction.",
        enabled: anySkeleton,
        start: (app) => new BendRun(app),
    },
    {
        id: "reshape",
        label: "Reshape",
        group: "branch",
        shortcut: "O",
        help: "Moves a node and its axis; the wheel sets the length that follows.",
        enabled: anySkeleton,
        start: (app) => new ReshapeRun(app),
    },
];
