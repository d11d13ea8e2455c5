// What the buttons of a mouse, a trackpad and fingers do in the picture.

export type Preset = "blender" | "cad" | "trackpad";
export type Motion = "orbit" | "pan" | "zoom";

export const kPresets: readonly Preset[] = ["blender", "cad", "trackpad"];

export const kPresetNames: readonly (readonly [Preset, string])[] = [
    ["blender", "Blender"],
    ["cad", "CAD"],
    ["trackpad", "Trackpad"],
];

const kLeft: [string, string] = ["Left button", "the tool in hand; turns where that takes nothing. With Alt it always turns"];
const kFingers: [string, string][] = [
    ["One finger", "turns; a tap picks, a long press shows what is there"],
    ["Two fingers", "move, and zoom by pinching"],
    ["Double click", "puts what is there into the middle"],
];

/** What each button does, for people. */
export const kPresetButtons: Record<Preset, readonly [string, string][]> = {
    blender: [kLeft, ["Middle button", "turns; with Shift it moves, with Ctrl it zooms"], ["Right button", "moves"], ["Wheel", "zooms to the pointer"], ...kFingers],
    cad: [kLeft, ["Middle button", "moves"], ["Right button", "turns; with Ctrl it moves, with Shift it zooms"], ["Wheel", "zooms to the pointer"], ...kFingers],
    trackpad: [kLeft, ["Two fingers on the pad", "turn; with Shift they move"], ["Pinching", "zooms to the pointer"], ["Right button", "moves"], ...kFingers],
};

export interface Keys {
    shift: boolean;
    control: boolean;
    alt: boolean;
}

/**
 * What a drag with a button (0 left, 1 middle, 2 right) does by itself; null: it is for the tool in hand, and turns the
 * picture where that does not take it.
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

/** What the wheel does, or two fingers on a trackpad; browsers report pinching as a wheel with Ctrl. */
export function wheelMotion(preset: Preset, keys: Keys): Motion {
    if (preset !== "trackpad" || keys.control) {
        return "zoom";
    }
    return keys.shift ? "pan" : "orbit";
}

/** The factor of the distance for a wheel event: about a tenth for a notch, whatever unit the browser counts in. */
export function wheelFactor(delta: number, mode: number): number {
    const pixels = delta * (mode === 1 ? 33 : mode === 2 ? 400 : 1);
    return Math.exp(Math.min(Math.max(pixels, -300), 300) * 0.001);
}
