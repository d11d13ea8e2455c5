// The functions of mouse buttons, trackpad and fingers in the view.

export type Preset = "blender" | "cad" | "trackpad";
export type Motion = "orbit" | "pan" | "zoom";

export const kPresets: readonly Preset[] = ["blender", "cad", "trackpad"];

export const kPresetNames: readonly (readonly [Preset, string])[] = [
    ["blender", "Blender"],
    ["cad", "CAD"],
    ["trackpad", "Trackpad"],
];

const kLeft: [string, string] = ["Left button", "the active tool; rotates if the tool does not use it. With Alt it always rotates"];
const kFingers: [string, string][] = [
    ["One finger", "rotates; a tap picks, a long press shows the object there"],
    ["Two fingers", "move, and zoom by pinching"],
    ["Double click", "centres the point there"],
];

/** Descriptions of the buttons. */
export const kPresetButtons: Record<Preset, readonly [string, string][]> = {
    blender: [
        kLeft,
        ["Middle button", "rotates; with Shift it moves, with Ctrl it zooms"],
        ["Right button", "moves"],
        ["Wheel", "zooms to the pointer"],
        ...kFingers,
    ],
    cad: [
        kLeft,
        ["Middle button", "moves"],
        ["Right button", "rotates; with Ctrl it moves, with Shift it zooms"],
        ["Wheel", "zooms to the pointer"],
        ...kFingers,
    ],
    trackpad: [kLeft, ["Two fingers on the pad", "rotate; with Shift they move"], ["Pinching", "zooms to the pointer"], ["Right button", "moves"], ...kFingers],
};

export interface Keys {
    shift: boolean;
    control: boolean;
    alt: boolean;
}

/**
 * The motion of a drag with a button (0 left, 1 middle, 2 right); null: the active tool receives the drag, and the view rotates
 * if the tool does not use it.
 */
export function dragMotion(preset: Preset, button: number, keys: Keys): Motion | null {
    if (button === 0) {
        return keys.alt ? (keys.shift ? "pan" : keys.control ? "zoom" : "orbit") : null;
    }
    if (preset === "cad") {
        return button === 1 ? "pan" : keys.control ? "pan" : keys.shift ? "zoom" : "orbit";
    }
    if (button === 2) {
        return "pan";
    }
    return keys.shift ? "pan" : keys.control ? "zoom" : "orbit";
}

/** The motion of the wheel, or of two fingers on a trackpad; browsers report pinching as a wheel with Ctrl. */
export function wheelMotion(preset: Preset, keys: Keys): Motion {
    if (preset !== "trackpad" || keys.control) {
        return "zoom";
    }
    return keys.shift ? "pan" : "orbit";
}

/** The zoom factor of a wheel event: about a tenth for a notch, in any unit of the browser. */
export function wheelFactor(delta: number, mode: number): number {
    const pixels = delta * (mode === 1 ? 33 : mode === 2 ? 400 : 1);
    return Math.exp(Math.min(Math.max(pixels, -300), 300) * 0.001);
}
