// Distances, angles, heights and radii of picked or typed points.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Label, Tool, ToolPointer, ToolRun } from "../app";
import type { Point } from "../protocol";
import { lengthText } from "../view/lengths";
import { Overlay, kColors } from "./kit/overlay";
import { Button, CheckField, PointField, pointSignals } from "./kit/fields";
import { skeletonOf } from "./kit/skeleton";
import { distance, mix } from "./kit/vector";
import { angleAt, degreesText, kMaxSpots, type Measure, measureText, radiusAt, type Spot, spotText } from "./measure_text";

const kStill = 4; // [px] maximum movement of a click
const kSnap = 14; // [px] maximum distance for snapping to a node
const kOwner = "measure";

const measures = signal<readonly Measure[]>([]); // the last one is unfinished while it has fewer than three points
const chosen = signal(-1);
const ended = signal(true); // whether the next point begins another measure
const snaps = signal(true);
const typedPoint = pointSignals([0, 0, 0]);

/** The point under the pointer, as an end of a measure. */
function spotAt(app: App, x: number, y: number): Spot | null {
    const pick = app.view.pick(x, y);
    if (!pick) {
        return null;
    }
    const { kind, name } = pick.object;
    const skeleton = kind === "skeleton" ? skeletonOf(app, name) : null;
    const n = skeleton && pick.node !== undefined ? skeleton.index(pick.node) : -1;
    if (!skeleton || n < 0) {
        return { at: pick.point, of: `${kind} ${name}` };
    }
    const parent = skeleton.parent(n);
    const near = [n, parent]
        .filter((node) => node >= 0 && snaps.peek())
        .find((node) => {
            const [px, py] = app.view.toPixels(skeleton.at(node));
            return Math.hypot(px - x, py - y) <= kSnap;
        });
    if (near !== undefined) {
        return { at: skeleton.at(near), radius: skeleton.radius[near], of: `node ${skeleton.ids[near]} of ${name}` };
    }
    const leads = parent >= 0 && skeleton.leader(parent) === n;
    const inner = leads ? skeleton.radius[parent] : skeleton.radius[n]; // other branches keep their radius down to the axis
    const radius = parent < 0 ? skeleton.radius[n] : radiusAt(pick.point, skeleton.at(parent), skeleton.at(n), [inner, skeleton.radius[n]]);
    return { at: pick.point, radius, of: `branch of ${name}` };
}

function addSpot(spot: Spot): void {
    const before = measures.peek();
    const last = before[before.length - 1];
    measures.value = ended.peek() || !last ? [...before, [spot]] : [...before.slice(0, -1), [...last, spot]];
    const now = measures.peek();
    chosen.value = now.length - 1;
    ended.value = now[now.length - 1].length === kMaxSpots;
}

function remove(at: number): void {
    if (at >= 0) {
        measures.value = measures.peek().filter((_, i) => i !== at);
        ended.value = true;
        chosen.value = Math.min(at, measures.peek().length - 1);
    }
}

/** Labels at the points of a measure. */
function labelsOf(measure: Measure, isChosen: boolean): Label[] {
    const [a, b, c] = measure;
    const style = isChosen ? "strong" : undefined;
    if (!b) {
        const text = a.radius === undefined ? `height ${lengthText(a.at[2])}` : `⌀ ${lengthText(2 * a.radius)}, height ${lengthText(a.at[2])}`;
        return [{ at: a.at, text, style }];
    }
    const between = ([p, q]: Spot[]): Label => ({ at: mix(p.at, q.at, 0.5), text: lengthText(distance(p.at, q.at), 4), style });
    return c ? [between([a, b]), between([b, c]), { at: b.at, text: degreesText(angleAt(measure)), style }] : [between([a, b])];
}

async function copy(app: App, text: string): Promise<void> {
    try {
        await navigator.clipboard.writeText(text);
        app.store.notify("Copied.");
    } catch {
        app.store.notify("The browser does not let the page copy; select the text and copy it by hand.", "warning");
    }
}

class MeasureRun implements ToolRun {
    private readonly overlay: Overlay;
    private pressed: { x: number; y: number } | null = null;
    private under: Spot | null = null;

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.show();
    }

    stop(): void {
        if (!ended.peek()) {
            this.leave();
        }
        this.overlay.stop();
        this.app.view.setLabels(kOwner, []);
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down") {
            this.pressed = event.buttons === 1 ? { x: event.x, y: event.y } : null;
        } else if (event.phase === "move" && event.buttons === 0) {
            this.under = spotAt(this.app, event.x, event.y);
            this.show();
        } else if (event.phase === "up" && this.pressed) {
            const still = Math.hypot(event.x - this.pressed.x, event.y - this.pressed.y) <= kStill;
            const spot = still ? spotAt(this.app, event.x, event.y) : null;
            if (spot) {
                addSpot(spot);
                this.show();
            }
            this.pressed = null;
        }
        return false; // a drag rotates the view
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Enter" && !ended.peek()) {
            ended.value = true;
        } else if (event.key === "Escape" && !ended.peek()) {
            this.leave();
        } else if ((event.key === "Delete" || event.key === "Backspace") && chosen.peek() >= 0) {
            remove(chosen.peek());
        } else {
            return false;
        }
        this.show();
        return true;
    }

    status(): string {
        const { value } = measures;
        const last = ended.value ? undefined : value[value.length - 1];
        if (last && this.under) {
            const to = [...last.slice(-1), this.under];
            return `${lengthText(distance(to[0].at, to[1].at), 4)} to ${spotText(this.under)}`;
        }
        if (this.under) {
            return spotText(this.under);
        }
        return last ? "Click the next point; a third one measures an angle. Enter ends it here." : "Click the first point of a measure.";
    }

    panel(): VNode {
        const list = measures.value;
        return (
            <>
                <CheckField label="Snap to nodes" value={snaps} />
                <PointField label="Point" value={typedPoint} />
                <div class="tool-row">
                    <Button label={ended.value ? "Start with this point" : "Add this point"} run={() => this.addTyped()} />
                    <Button label="End here" disabled={ended.value} run={() => this.change(() => void (ended.value = true))} />
                </div>
                {list.length > 0 && (
                    <ol class="measure-list" aria-label="Measures">
                        {list.map((measure, i) => this.row(measure, i))}
                    </ol>
                )}
                {list.length > 1 && (
                    <div class="tool-row">
                        <Button label="Copy all" run={() => void copy(this.app, list.map((one) => measureText(one).join("; ")).join("\n"))} />
                        <Button label="Delete all" run={() => this.change(() => this.clear())} />
                    </div>
                )}
            </>
        );
    }

    private row(measure: Measure, i: number): VNode {
        const text = measureText(measure);
        return (
            <li key={i} class={i === chosen.value ? "chosen" : undefined}>
                <button type="button" class="measure" aria-pressed={i === chosen.value} onClick={() => this.change(() => void (chosen.value = i))}>
                    {text.map((line) => (
                        <span key={line}>{line}</span>
                    ))}
                </button>
                <button type="button" onClick={() => void copy(this.app, text.join("; "))}>
                    Copy
                </button>
                <button type="button" class="icon" aria-label="Delete this measure" onClick={() => this.change(() => remove(i))}>
                    ×
                </button>
            </li>
        );
    }

    private addTyped(): void {
        this.change(() => addSpot({ at: typedPoint.map((part) => part.peek()) as Point }));
    }

    private clear(): void {
        measures.value = [];
        chosen.value = -1;
        ended.value = true;
    }

    private change(edit: () => void): void {
        edit();
        this.show();
    }

    // Discards the points of the unfinished measure.
    private leave(): void {
        remove(measures.peek().length - 1);
    }

    private show(): void {
        this.overlay.clear();
        const list = measures.peek();
        const labels = list.flatMap((measure, i) => {
            const color = i === chosen.peek() ? kColors.hot : kColors.plain;
            const points = measure.map(({ at }) => at);
            this.overlay.line(points, color);
            this.overlay.dots(points, color);
            return labelsOf(measure, i === chosen.peek());
        });
        const last = ended.peek() ? undefined : list[list.length - 1];
        const from = last?.[last.length - 1];
        if (this.under) {
            this.overlay.dots([this.under.at], kColors.hot, 7);
        }
        if (from && this.under) {
            this.overlay.line([from.at, this.under.at], kColors.hot);
            labels.push({ at: this.under.at, text: lengthText(distance(from.at, this.under.at), 4), style: "strong" });
        } else if (this.under?.radius !== undefined) {
            labels.push({ at: this.under.at, text: `⌀ ${lengthText(2 * this.under.radius)}`, style: "faint" });
        }
        this.app.view.setLabels(kOwner, labels);
    }
}

export const measureTools: Tool[] = [
    {
        id: "measure",
        label: "Measure",
        group: "view",
        shortcut: "M",
        help: "Measures distances between points, an angle with a third point, and shows radius and height at the pointer.",
        start: (app) => new MeasureRun(app),
    },
];
