// Cross-sections drawn in a plane: control points are added, dragged, typed and deleted.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolRun } from "../../app";
import { Tracked } from "../../use";
import { SidePane } from "../kit/side_pane";
import { Button, CheckField, ChoiceField, NumberField, TextField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { type Controls, findControls, replaceStatement } from "../kit/source";
import { snapped } from "../kit/vector";
import { framing, gridStep, type Outline, outlineLine, type Place, pieceAt, type Plane, toPlace, zoomed } from "./plane";
import { PlaneView } from "./plane_view";

const kKinds: readonly (readonly [string, string])[] = [
    ["polyline", "Straight"],
    ["catmull_rom", "Smooth"],
    ["natural", "Natural spline"],
];
const kCommands: readonly (readonly ["profile" | "contour", string])[] = [
    ["profile", "Line or area"],
    ["contour", "Smooth outline"],
];
const kHit = 6; // [px] maximum distance from the outline at which a click adds a point to it
const kNudge = 5; // [px] of an arrow key

let kept: readonly Place[] = []; // an unfinished drawing, for the next use of the tool

class ProfileRun implements ToolRun {
    private readonly command: Signal<"profile" | "contour"> = signal("profile");
    private readonly name = signal("");
    private readonly points: Signal<readonly Place[]> = signal([]);
    private readonly closed = signal(true);
    private readonly kind = signal("polyline");
    private readonly active = signal(-1);
    private readonly plane: Signal<Plane> = signal({ scale: 80, left: 0, top: 0 });
    private readonly typedX = signal(0);
    private readonly typedY = signal(0);
    private readonly editing: Signal<Controls | null> = signal(null);
    private gesture: Gesture | null = null;
    private readonly writes = signal(0); // pending changes, which are not yet in the document
    private dragging = false;
    private readonly sidePane: SidePane;
    private readonly stopEffect: () => void;

    constructor(private readonly app: App) {
        this.sidePane = new SidePane(app, "profile-editor");
        this.name.value = app.store.freeName("outline");
        this.points.value = kept;
        this.reframe();
        this.stopEffect = effect(() => {
            const { object } = app.store.selection.value;
            const state = app.store.state.value;
            if (this.writes.value === 0 && !this.dragging) {
                this.read(object?.kind === "profile" ? findControls(state, object, ["profile", "contour"]) : null);
            }
        });
        this.sidePane.render(<Tracked draw={() => this.picture()} />);
    }

    stop(): void {
        this.stopEffect();
        this.gesture?.cancel();
        kept = this.editing.peek() ? [] : this.points.peek();
        this.sidePane.stop();
    }

    status(): string {
        return this.gesture?.refusal || "Click to add points, drag them, Delete removes one; the wheel zooms, Shift and a drag move the plane.";
    }

    key(event: KeyboardEvent): boolean {
        const isChosen = this.active.peek() >= 0;
        if ((event.key === "Delete" || event.key === "Backspace") && isChosen) {
            this.remove();
            return true;
        }
        if (event.key.startsWith("Arrow") && isChosen && !event.ctrlKey && !event.altKey) {
            const far = event.shiftKey ? kNudge / 10 : kNudge;
            const [dx, dy] = { ArrowLeft: [-far, 0], ArrowRight: [far, 0], ArrowUp: [0, far], ArrowDown: [0, -far] }[event.key] ?? [0, 0];
            this.nudge(dx, dy);
            return true;
        }
        if (event.key === "Enter" && !this.editing.peek()) {
            void this.make();
            return true;
        }
        return false;
    }

    panel(): VNode {
        const chosen = this.active.value >= 0;
        return (
            <>
                {!this.editing.value && <TextField label="Name" value={this.name} />}
                {!this.editing.value && <ChoiceField label="Is" value={this.command} choices={kCommands} changed={() => this.show()} />}
                {this.command.value === "profile" && (
                    <>
                        <ChoiceField label="Curve" value={this.kind} choices={kKinds} changed={() => this.changed()} />
                        <CheckField label="Closed" value={this.closed} changed={() => this.changed()} />
                    </>
                )}
                <NumberField label="X" unit="m" value={this.typedX} changed={() => chosen && this.type()} />
                <NumberField label="Y" unit="m" value={this.typedY} changed={() => chosen && this.type()} />
                <div class="tool-row">
                    <Button label="Add point" run={() => this.addTyped()} />
                    <Button label="Delete point" run={() => this.remove()} disabled={!chosen} />
                    <Button label="Show all" run={() => this.reframe()} />
                </div>
                <div class="tool-row">
                    {this.editing.value ? (
                        <>
                            <Button label="Make a solid of it" run={() => this.app.take("loft")} />
                            <Button label="A new profile" run={() => this.renew()} />
                        </>
                    ) : (
                        <>
                            <Button label="Make it" run={() => void this.make()} disabled={this.points.value.length < 2} />
                            <Button label="Start again" run={() => this.clear()} disabled={this.points.value.length === 0} />
                        </>
                    )}
                    <Button label="Done" run={() => this.app.take("select")} />
                </div>
            </>
        );
    }

    private picture(): VNode {
        return (
            <PlaneView
                points={this.points.value}
                closed={this.closed.value || this.command.value === "contour"}
                smooth={this.kind.value !== "polyline" || this.command.value === "contour"}
                active={this.active.value}
                plane={this.plane.value}
                size={[this.sidePane.element.clientWidth || 400, this.sidePane.element.clientHeight || 400]}
                choose={(index, held) => this.choose(index, held)}
                add={(x, y, snap) => this.addAt(x, y, snap)}
                drag={(x, y, snap) => this.dragTo(x, y, snap)}
                drop={() => this.drop()}
                pan={(dx, dy) => {
                    const { scale, left, top } = this.plane.peek();
                    this.plane.value = { scale, left: left + dx, top: top + dy };
                }}
                zoom={(x, y, factor) => {
                    this.plane.value = zoomed(this.plane.peek(), x, y, factor);
                }}
            />
        );
    }

    private read(controls: Controls | null): void {
        const before = this.editing.peek();
        const plain = controls?.points.every((point) => point.length === 2) && controls.points.length > 1 ? controls : null;
        if (!plain && !before) {
            return;
        }
        this.editing.value = plain;
        this.points.value = (plain?.points ?? []) as unknown as Place[];
        if (plain) {
            this.command.value = plain.command as "profile" | "contour";
            this.name.value = plain.name;
            this.closed.value = plain.options.closed !== "false";
            this.kind.value = plain.options.kind ?? "polyline";
        }
        if (before?.name !== plain?.name) {
            this.active.value = -1;
            this.reframe();
        }
    }

    private renew(): void {
        this.app.store.selection.value = { ...this.app.store.selection.peek(), object: null, nodes: [] };
        this.name.value = this.app.store.freeName("outline");
    }

    private reframe(): void {
        const { clientWidth, clientHeight } = this.sidePane.element;
        this.plane.value = framing(this.points.peek(), clientWidth || 400, clientHeight || 400);
    }

    private choose(index: number, held: boolean): void {
        this.active.value = index;
        const place = this.points.peek()[index];
        if (place) {
            [this.typedX.value, this.typedY.value] = place;
        }
        this.dragging = held;
    }

    private clear(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.points.value = [];
        this.active.value = -1;
    }

    private addAt(x: number, y: number, snap: boolean): void {
        const plane = this.plane.peek();
        const points = this.points.peek();
        const closed = this.closed.peek() || this.command.peek() === "contour";
        const before = pieceAt(points, closed, plane, x, y, kHit);
        const at = before < 0 ? points.length : before;
        this.points.value = [...points.slice(0, at), this.placeOf(x, y, snap), ...points.slice(at)];
        this.choose(at, true);
        this.show();
    }

    private addTyped(): void {
        const points = this.points.peek();
        this.points.value = [...points, [this.typedX.peek(), this.typedY.peek()]];
        this.active.value = points.length;
        this.changed();
    }

    private placeOf(x: number, y: number, snap: boolean): Place {
        const plane = this.plane.peek();
        const grid = snap ? gridStep(plane) / 4 : 0;
        const place = toPlace(plane, x, y);
        return [snapped(place[0], grid), snapped(place[1], grid)];
    }

    private dragTo(x: number, y: number, snap: boolean): void {
        this.set(this.placeOf(x, y, snap));
    }

    private set(place: Place): void {
        const active = this.active.peek();
        this.points.value = this.points.peek().map((point, i) => (i === active ? place : point));
        [this.typedX.value, this.typedY.value] = place;
        this.show();
    }

    private type(): void {
        this.set([this.typedX.peek(), this.typedY.peek()]);
        this.changed(true);
    }

    private nudge(dx: number, dy: number): void {
        const place = this.points.peek()[this.active.peek()];
        if (place) {
            const { scale } = this.plane.peek();
            this.set([place[0] + dx / scale, place[1] + dy / scale]);
            this.changed(true);
        }
    }

    private remove(): void {
        const active = this.active.peek();
        if (active >= 0 && (!this.editing.peek() || this.points.peek().length > 2)) {
            this.points.value = this.points.peek().filter((_, i) => i !== active);
            this.choose(Math.min(active, this.points.peek().length - 1), false);
            this.changed();
        }
    }

    private drop(): void {
        this.dragging = false;
        this.changed();
    }

    private outline(): Outline {
        return {
            command: this.command.peek(),
            name: this.name.peek(),
            points: this.points.peek(),
            closed: this.closed.peek(),
            kind: this.kind.peek(),
        };
    }

    private step(): number {
        return 0.1 / this.plane.peek().scale;
    }

    private show(): void {
        if (this.points.peek().length >= 3) {
            const before = this.editing.peek();
            const about = before ? { kind: "profile" as const, name: before.name } : undefined;
            this.gesture ??= new Gesture(this.app, about);
            this.gesture.preview(outlineLine(this.outline(), this.step(), before ? { options: before.options, comment: "" } : undefined));
        }
    }

    // An existing profile is rewritten at once, a new one when it is finished. Small steps of a point are joined.
    private changed(joins = false): void {
        const controls = this.editing.peek();
        if (!controls) {
            this.show();
            return;
        }
        const line = outlineLine(this.outline(), this.step(), controls);
        this.gesture = null;
        const name = joins ? `point ${this.active.peek() + 1} of ${controls.name}` : `points of ${controls.name}`;
        ++this.writes.value;
        void replaceStatement(this.app, { statement: controls.statement, text: line, name, joins }).then(() => --this.writes.value);
    }

    private async make(): Promise<void> {
        const gesture = this.gesture ?? new Gesture(this.app);
        const name = this.name.peek();
        this.gesture = null;
        if ((await gesture.run(outlineLine(this.outline(), this.step()))) !== null) {
            this.app.store.selection.value = { ...this.app.store.selection.peek(), object: { kind: "profile", name }, nodes: [] };
            this.reframe();
        }
    }
}

export const profileTools: Tool[] = [
    {
        id: "profile",
        label: "Profile",
        group: "crown",
        help: "Draws the cross-section of a revolution, sweep or skin in a plane, and edits the points of a selected profile.",
        start: (app) => new ProfileRun(app),
    },
];
