// Colour maps for numbers.

// Viridis at nine samples: perceptually uniform, and suitable for colour-blind users.
const kViridis = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

// Blue below the middle and red above it, suitable for colour-blind users.
const kDiverging = [
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [240, 240, 238],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
];

export type ColorMap = "even" | "diverging";

const kMaps: Record<ColorMap, number[][]> = { even: kViridis, diverging: kDiverging };

/** Red, green and blue in [0, 255] for a number in [0, 1]; numbers outside are clamped. */
export function colorOf(t: number, map: ColorMap = "even"): [number, number, number] {
    const stops = kMaps[map];
    const at = Math.min(Math.max(Number.isFinite(t) ? t : 0, 0), 1) * (stops.length - 1);
    const k = Math.min(Math.floor(at), stops.length - 2);
    const f = at - k;
    return [0, 1, 2].map((c) => Math.round(stops[k][c] + (stops[k + 1][c] - stops[k][c]) * f)) as [number, number, number];
}

const kSteps = 256;

function linear(byte: number): number {
    const s = byte / 255;
    return Math.round(255 * (s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4));
}

function table(map: ColorMap, shade: (byte: number) => number): Uint8Array {
    return Uint8Array.from({ length: kSteps * 3 }, (_, i) => shade(colorOf(Math.floor(i / 3) / (kSteps - 1), map)[i % 3]));
}

const asIs = (byte: number): number => byte;
const kLinear = { even: table("even", linear), diverging: table("diverging", linear) };
const kScreen = { even: table("even", asIs), diverging: table("diverging", asIs) };

/** Numbers at the ends of a map. */
export interface Range {
    low: number;
    high: number;
}

function fill(values: Float32Array, { low, high }: Range, shades: Uint8Array): Uint8Array<ArrayBuffer> {
    const colors = new Uint8Array(values.length * 4);
    const scale = (kSteps - 1) / (high - low || 1);
    for (let i = 0; i < values.length; ++i) {
        const t = Math.round((values[i] - low) * scale);
        const at = 3 * (t > 0 ? (t < kSteps ? t : kSteps - 1) : 0);
        colors[4 * i] = shades[at];
        colors[4 * i + 1] = shades[at + 1];
        colors[4 * i + 2] = shades[at + 2];
        colors[4 * i + 3] = 255;
    }
    return colors;
}

/** Colours for vertices, linear, four bytes each. */
export function paint(values: Float32Array, range: Range, map: ColorMap = "even"): Uint8Array<ArrayBuffer> {
    return fill(values, range, kLinear[map]);
}

/** Colours for the texels of an image, in sRGB. */
export function paintTexels(values: Float32Array, range: Range, map: ColorMap = "even"): Uint8Array<ArrayBuffer> {
    return fill(values, range, kScreen[map]);
}

/** The map as a CSS gradient from left to right. */
export function cssGradient(map: ColorMap): string {
    return `linear-gradient(to right, ${kMaps[map].map((c) => `rgb(${c.join(" ")})`).join(", ")})`;
}
