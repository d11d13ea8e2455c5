// Changes radii by the wheel over a branch, by a horizontal drag, or by a typed factor.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer } from "../../app";
import { BranchDragRun, type Held } from "../kit/branch_drag";
import { CheckField, NumberField } from "../kit/fields";
import type { NodeLine } from "../kit/naming";
import { skeletonOf } from "../kit/skeleton";
import { commandLine, numberWord, sizeWord } from "../kit/words";
import { anySkeleton } from "./cut";

const kIdle = 600; // [ms] after which the gesture of the wheel ends
const kWheel = 1 / 1500; // for a pixel of the wheel, on the logarithm of the factor
const kDrag = 1 / 150;

const onlyNode = signal(false);
const factorField = signal(1);

class RadiusRun extends BranchDragRun {
    private wheeled = 0; // logarithm of the factor
    private timer: ReturnType<typeof setTimeout> | undefined;

    constructor(app: App) {
        super(app);
        factorField.value = 1;
    }

    override stop(): void {
        clearTimeout(this.timer);
        this.end(); // the change by the wheel is kept
        super.stop();
    }

    wheel(delta: number, event: ToolPointer): boolean {
        if (this.wheeled === 0) {
            const pick = this.app.view.pick(event.x, event.y, ["skeleton"]);
            const skeleton = pick && skeletonOf(this.app, pick.object.name);
            const n = skeleton && pick?.node !== undefined ? skeleton.index(pick.node) : -1;
            if (!pick || !skeleton || n < 0) {
                return false;
            }
            this.held = { about: pick.object, skeleton, n, ids: [skeleton.ids[n]] };
        }
        this.wheeled -= delta * kWheel;
        this.show();
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.end(), kIdle);
        return true;
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Factor" value={factorField} low={0.01} high={100} changed={() => this.show()} />
                <CheckField label="Only the node" value={onlyNode} changed={() => this.show()} />
            </>
        );
    }

    protected nodeLine(held: Held): NodeLine | null {
        const { name } = held.about;
        const nodes = [held.ids];
        const within = (chosen: string) => (onlyNode.peek() ? chosen : `axis(${chosen})`);
        const typed = this.typed.values()?.[0];
        if (typed !== undefined && typed > 0 && onlyNode.peek()) {
            return {
                name,
                nodes,
                line: ([chosen]) => commandLine(["edit", "radius", name, within(chosen), sizeWord(typed, 1e-5)]),
            };
        }
        const factor = typed !== undefined ? typed : this.factor();
        if (!(factor > 0) || Math.abs(factor - 1) < 1e-3) {
            return null;
        }
        return {
            name,
            nodes,
            line: ([chosen]) => commandLine(["edit", "thicken", name, within(chosen), sizeWord(factor, 1e-3)]),
        };
    }

    protected text(held: Held | null): string {
        if (!held) {
            return "Turn the wheel over a branch to make it thicker or thinner, or drag it horizontally.";
        }
        const radius = held.skeleton.radius[held.n];
        const prompt = onlyNode.value ? "Type a radius in metres" : "Type a factor";
        const times = `${numberWord(radius, 1e-4)} m times ${numberWord(this.factor(), 0.01)}`;
        return `Radius at node ${held.skeleton.ids[held.n]}: ${times}. ${prompt}; Enter ends.`;
    }

    protected override clear(): void {
        clearTimeout(this.timer);
        this.wheeled = 0;
        factorField.value = 1;
    }

    protected override end(): void {
        if (this.isInProgress() || factorField.peek() !== 1) {
            super.end();
        }
    }

    protected override isInProgress(): boolean {
        return super.isInProgress() || this.wheeled !== 0;
    }

    private factor(): number {
        const dragged = this.from && this.last ? (this.last.x - this.from.x) * kDrag : 0;
        return Math.exp(this.wheeled + dragged) * factorField.value;
    }
}

export const radiusTools: Tool[] = [
    {
        id: "radius",
        label: "Radius",
        group: "branch",
        shortcut: "T",
        help: "Makes branches thicker or thinner by the wheel, by a horizontal drag, or by a typed factor.",
        enabled: anySkeleton,
        start: (app) => new RadiusRun(app),
    },
];
