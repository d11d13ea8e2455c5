// Numbers and axes that are typed while a gesture is under way: "2", "1,0,2.5", X, Shift+Z, Enter.
import type { Point } from "../../protocol";
import { across, kAxes } from "./vector";

export type Axis = "x" | "y" | "z";

export class Typed {
    text = "";
    axis: Axis | null = null;
    plane = false; // across the axis in place of along it

    /** Whether the key was one of a number or an axis. */
    key(event: KeyboardEvent): boolean {
        if (event.ctrlKey || event.metaKey || event.altKey) {
            return false;
        }
        const key = event.key.toLowerCase();
        if (key === "x" || key === "y" || key === "z") {
            const again = this.axis === key && this.plane === event.shiftKey;
            this.axis = again ? null : key;
            this.plane = !again && event.shiftKey;
            return true;
        }
        if (/^[0-9.,-]$/.test(event.key)) {
            // A minus anywhere turns the sign of the number that is being typed, as in other modellers.
            this.text = event.key === "-" ? this.turned() : this.text + event.key;
            return true;
        }
        if (event.key === " " && this.text !== "") {
            this.text += ",";
            return true;
        }
        if (event.key === "Backspace" && this.text !== "") {
            this.text = this.text.slice(0, -1);
            return true;
        }
        return false;
    }

    private turned(): string {
        const at = this.text.lastIndexOf(",") + 1;
        const last = this.text.slice(at);
        return this.text.slice(0, at) + (last.startsWith("-") ? last.slice(1) : `-${last}`);
    }

    /** The numbers typed; null where none is. */
    values(): number[] | null {
        if (!/[0-9]/.test(this.text)) {
            return null;
        }
        return this.text.split(",").map((part) => Number.parseFloat(part) || 0);
    }

    clear(): void {
        this.text = "";
        this.axis = null;
        this.plane = false;
    }

    /** What of a shift the axis or plane lets through. */
    constrain(by: Point): Point {
        if (!this.axis) {
            return by;
        }
        const axis = kAxes[this.axis];
        const kept = across(by, axis);
        return this.plane ? kept : [by[0] - kept[0], by[1] - kept[1], by[2] - kept[2]];
    }

    /** The axis for people: "along Z", "across Z", or nothing. */
    constraint(): string {
        return this.axis ? `${this.plane ? "across" : "along"} ${this.axis.toUpperCase()}` : "";
    }
}

/** A shift as typed: one number goes along the axis (x without one), several along x, y and z. */
export function typedShift(typed: Typed): Point | null {
    const values = typed.values();
    if (!values) {
        return null;
    }
    if (values.length === 1 && typed.axis && !typed.plane) {
        const axis = kAxes[typed.axis];
        return [axis[0] * values[0], axis[1] * values[0], axis[2] * values[0]];
    }
    return typed.constrain([values[0], values[1] ?? 0, values[2] ?? 0]);
}
