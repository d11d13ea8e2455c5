// Rotation, pan and zoom of the view by mouse, trackpad, touch and keys.
import * as THREE from "three";
import type { ToolPointer } from "../../app";
import type { ActiveTool } from "../../active_tool";
import { dragMotion, type Keys, type Motion, type Preset, wheelFactor, wheelMotion } from "./presets";
import type { Rig } from "./rig";

const kTurn = 0.007; // [rad] per pixel
const kClick = 4; // [px] maximum movement of a click
const kTap = 10; // [px] the same for a finger
const kLong = 450; // [ms] time after which a resting finger shows the object under it
const kKeyTurn = Math.PI / 24;
const kKeyMove = 40; // [px]

/** Functions of the view that navigation uses. */
export interface Navigated {
    rig: Rig;
    canvas: HTMLCanvasElement;
    preset(): Preset;
    pointUnder(x: number, y: number): THREE.Vector3 | null;
    hovered(x: number, y: number): void; // pointer position without a pressed button; far outside if it has left
    own(event: ToolPointer): boolean; // handles of the view itself
    moved(): void; // the pose has changed
    centre(point: THREE.Vector3): void;
}

interface Held {
    x: number;
    y: number;
}

type Phase = "idle" | "tool" | "own" | "undecided" | "moving" | "looking";

export class Navigation {
    enabled = true; // tools with a drag disable it
    private phase: Phase = "idle";
    private motion: Motion = "orbit";
    private start: Held = { x: 0, y: 0 };
    private readonly held = new Map<number, Held>(); // pressed fingers and buttons
    private readonly pivot = new THREE.Vector3();
    private wasTool = false; // the last press was used by a tool
    private longPress: ReturnType<typeof setTimeout> | undefined;

    constructor(
        private readonly view: Navigated,
        private readonly activeTool: () => ActiveTool | null,
    ) {
        const { canvas } = view;
        canvas.addEventListener("pointerdown", (event) => this.down(event));
        canvas.addEventListener("pointermove", (event) => this.move(event));
        canvas.addEventListener("pointerup", (event) => this.up(event));
        canvas.addEventListener("pointercancel", (event) => this.cancel(event));
        canvas.addEventListener("pointerleave", (event) => this.leave(event));
        canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
        canvas.addEventListener("dblclick", (event) => this.doubleClick(event));
        canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    }

    /** Whether the view is moving. */
    get isMoving(): boolean {
        return this.phase === "moving";
    }

    private sendToTool(event: PointerEvent, phase: ToolPointer["phase"], at?: Held): boolean {
        return this.activeTool()?.pointer({ ...toolPointer(event, phase), ...at }) ?? false;
    }

    private down(event: PointerEvent): void {
        this.view.canvas.focus({ preventScroll: true });
        this.view.canvas.setPointerCapture(event.pointerId);
        this.held.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
        if (event.pointerType === "touch" && this.held.size > 1) {
            this.beginFingers(event);
            return;
        }
        this.start = { x: event.offsetX, y: event.offsetY };
        const own = dragMotion(this.view.preset(), event.button, keysOf(event));
        if (own) {
            this.begin(own, event.offsetX, event.offsetY);
        } else if (this.view.own(toolPointer(event, "down"))) {
            this.phase = "own";
        } else {
            this.phase = this.sendToTool(event, "down") ? "tool" : "undecided";
            if (event.pointerType === "touch" && this.phase === "undecided") {
                this.longPress = setTimeout(() => this.look(event), kLong);
            }
        }
    }

    // A resting finger shows the object under it, like a pointer, until it is lifted.
    private look(event: PointerEvent): void {
        if (this.phase === "undecided" && this.held.size === 1) {
            this.sendToTool(event, "cancel");
            this.phase = "looking";
            this.view.hovered(this.start.x, this.start.y);
        }
    }

    private leave(event: PointerEvent): void {
        if (event.pointerType !== "touch") {
            // the information for a finger remains visible after it is lifted
            this.view.hovered(-1e4, -1e4);
        }
    }

    private move(event: PointerEvent): void {
        const last = this.held.get(event.pointerId);
        if (!last) {
            this.sendToTool(event, "move");
            this.view.hovered(event.offsetX, event.offsetY);
            return;
        }
        if (event.pointerType === "touch" && this.held.size > 1) {
            this.moveFingers(event, last);
            return;
        }
        const [dx, dy] = [event.offsetX - last.x, event.offsetY - last.y];
        if (this.phase === "tool") {
            this.sendToTool(event, "move");
        } else if (this.phase === "own") {
            this.view.own(toolPointer(event, "move"));
        } else if (this.phase === "undecided") {
            const most = event.pointerType === "touch" ? kTap : kClick;
            const isFar = Math.hypot(event.offsetX - this.start.x, event.offsetY - this.start.y) > most;
            if (!isFar || !this.enabled) {
                return;
            }
            this.sendToTool(event, "cancel");
            this.begin("orbit", this.start.x, this.start.y);
            this.drag(event.offsetX - this.start.x, event.offsetY - this.start.y);
        } else if (this.phase === "moving") {
            this.drag(dx, dy);
        } else if (this.phase === "looking") {
            this.view.hovered(event.offsetX, event.offsetY);
        }
        last.x = event.offsetX;
        last.y = event.offsetY;
    }

    private up(event: PointerEvent): void {
        clearTimeout(this.longPress);
        this.held.delete(event.pointerId);
        this.wasTool = this.phase === "tool";
        if (this.phase === "tool") {
            this.sendToTool(event, "up");
        } else if (this.phase === "undecided") {
            this.sendToTool(event, "up", this.start); // a click, independent of small movements of the finger
        } else if (this.phase === "own") {
            this.view.own(toolPointer(event, "up"));
        }
        this.finish();
    }

    private cancel(event: PointerEvent): void {
        clearTimeout(this.longPress);
        this.held.delete(event.pointerId);
        if (this.phase === "tool" || this.phase === "undecided") {
            this.sendToTool(event, "cancel");
        }
        this.finish();
    }

    private finish(): void {
        if (this.held.size === 0) {
            this.phase = "idle";
            this.view.moved();
        }
    }

    private begin(motion: Motion, x: number, y: number): void {
        this.phase = "moving";
        this.motion = motion;
        this.pivot.copy(this.view.pointUnder(x, y) ?? this.view.rig.target());
    }

    private drag(dx: number, dy: number): void {
        this.apply(this.motion, dx, dy);
    }

    private apply(motion: Motion, dx: number, dy: number): void {
        const { rig } = this.view;
        if (motion === "orbit") {
            rig.orbit(-dx * kTurn, dy * kTurn, this.pivot);
        } else if (motion === "pan") {
            rig.pan(dx, dy, Math.max(rig.depth(this.pivot), rig.pose.distance * 0.05));
        } else {
            rig.zoom(Math.exp(dy * 0.01), this.pivot);
        }
        this.view.moved();
    }

    private beginFingers(event: PointerEvent): void {
        clearTimeout(this.longPress);
        if (this.phase === "tool" || this.phase === "undecided") {
            this.sendToTool(event, "cancel");
        }
        const [a, b] = [...this.held.values()];
        this.begin("pan", (a.x + b.x) / 2, (a.y + b.y) / 2);
    }

    // Two fingers: their centre moves the view, their distance zooms.
    private moveFingers(event: PointerEvent, last: Held): void {
        const before = [...this.held.values()].map((one) => ({ ...one }));
        last.x = event.offsetX;
        last.y = event.offsetY;
        const after = [...this.held.values()];
        const middle = (two: Held[]) => ({ x: (two[0].x + two[1].x) / 2, y: (two[0].y + two[1].y) / 2 });
        const apart = (two: Held[]) => Math.max(Math.hypot(two[0].x - two[1].x, two[0].y - two[1].y), 10);
        const [from, to] = [middle(before), middle(after)];
        this.view.rig.zoom(apart(before) / apart(after), this.pivot);
        this.apply("pan", to.x - from.x, to.y - from.y);
    }

    private wheel(event: WheelEvent): void {
        event.preventDefault();
        if (this.activeTool()?.wheel(event.deltaY, toolPointer(event, "move"))) {
            return;
        }
        const { rig } = this.view;
        const under = this.view.pointUnder(event.offsetX, event.offsetY);
        this.pivot.copy(under ?? rig.target());
        const motion = wheelMotion(this.view.preset(), keysOf(event));
        if (motion === "zoom") {
            const pinch = event.ctrlKey ? 6 : 1; // browsers report pinching in small steps
            rig.zoom(wheelFactor(event.deltaY * pinch, event.deltaMode), under ?? this.farPoint(event.offsetX, event.offsetY));
            this.view.moved();
        } else {
            this.apply(motion, -event.deltaX, -event.deltaY);
        }
    }

    // The point under the pointer at the distance of the target.
    private farPoint(x: number, y: number): THREE.Vector3 {
        const { rig, canvas } = this.view;
        const size = rig.pixelSize(rig.pose.distance);
        return rig
            .target()
            .addScaledVector(rig.right(), (x - canvas.clientWidth / 2) * size)
            .addScaledVector(rig.up(), (canvas.clientHeight / 2 - y) * size);
    }

    private doubleClick(event: MouseEvent): void {
        const under = this.wasTool ? null : this.view.pointUnder(event.offsetX, event.offsetY);
        if (under) {
            this.view.centre(under);
        }
    }

    /** Handles keys that move the view: arrows, + and -. Returns whether the key was used. */
    key(event: KeyboardEvent): boolean {
        if (event.ctrlKey || event.metaKey || event.altKey) {
            return false;
        }
        const { rig } = this.view;
        const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
        const arrow = arrows[event.key];
        if (arrow && event.shiftKey) {
            rig.pan(-arrow[0] * kKeyMove, arrow[1] * kKeyMove, rig.pose.distance);
        } else if (arrow) {
            rig.orbit(arrow[0] * kKeyTurn, arrow[1] * kKeyTurn, rig.target());
        } else if (event.key === "+" || event.key === "-") {
            rig.zoom(event.key === "+" ? 0.8 : 1.25, rig.target());
        } else {
            return false;
        }
        this.view.moved();
        return true;
    }
}

function keysOf(event: MouseEvent): Keys {
    return { shift: event.shiftKey, control: event.ctrlKey || event.metaKey, alt: event.altKey };
}

function toolPointer(event: PointerEvent | WheelEvent, phase: ToolPointer["phase"]): ToolPointer {
    const pointer = event instanceof PointerEvent ? event : null;
    const type = pointer?.pointerType;
    return {
        phase,
        x: event.offsetX,
        y: event.offsetY,
        buttons: event.buttons,
        pressure: pointer && pointer.pressure > 0 ? pointer.pressure : 0.5,
        type: type === "touch" || type === "pen" ? type : "mouse",
        ...keysOf(event),
    };
}
