// Numbers and axes that are typed during a gesture: "2", "1,0,2.5", X, Shift+Z, Enter.
import type { Point } from "../../protocol";
import { across, kAxes } from "./vector";

export type Axis = "x" | "y" | "z";

export class TypedInput {
    text = "";
    axis: Axis | null = null;
    plane = false; // across the axis instead of along it

    /** Returns whether the key belongs to a number or an axis. */
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
            // A minus at any position changes the sign of the current number, as in other modellers.
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

    /** The typed numbers; null if there are no numbers. */
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

    /** The component of a shift along the axis or plane. */
    constrain(by: Point): Point {
        if (!this.axis) {
            return by;
        }
        const axis = kAxes[this.axis];
        const kept = across(by, axis);
        return this.plane ? kept : [by[0] - kept[0], by[1] - kept[1], by[2] - kept[2]];
    }

    /** The axis as text: "along Z", "across Z", or empty. */
    constraint(): string {
        return this.axis ? `${this.plane ? "across" : "along"} ${this.axis.toUpperCase()}` : "";
    }
}

/** A typed shift: one number is along the axis (default x), several are along x, y and z. */
export function typedShift(typed: TypedInput): Point | null {
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
