// The values for the colours of a geometry, and their range.
import type { Geometry } from "../app";
import type { ColorMap, Range } from "./colors";
import type { Coloring } from "./display";

interface Meaning {
    title: string;
    unit: string;
    map: ColorMap;
}

/** For the colourings that show numbers. */
export const kMeanings: Partial<Record<Coloring, Meaning>> = {
    radius: { title: "Radius", unit: "m", map: "even" },
    order: { title: "Order of branching", unit: "", map: "even" },
    deviation: { title: "Deviation", unit: "radii", map: "diverging" },
    evidence: { title: "Measured share of the radius", unit: "", map: "even" },
};

/** The colouring that the engine has to send; for the others the page has the numbers, or needs no numbers. */
export function requestedColor(color: Coloring, form: "axes" | "surface"): Coloring {
    return color === "crossings" || (form === "axes" && color === "deviation") ? "plain" : color;
}

export function valuesOf(geometry: Geometry, color: Coloring): Float32Array | null {
    if (!kMeanings[color]) {
        return null;
    }
    const { value, radius, order } = geometry.arrays;
    if (value && geometry.header.color === color) {
        return value as Float32Array;
    }
    const known = { radius, order }[color as string];
    return known ? Float32Array.from(known) : null;
}

const kMaxShare = 0.98; // share of the vertices with deviations inside the colour range
const kSample = 20000;

function rangeOfValues(values: Float32Array, color: Coloring): Range {
    if (color === "evidence") {
        return { low: 0, high: 1 };
    }
    if (color === "deviation") {
        const step = Math.ceil(values.length / kSample) || 1;
        const sizes = values
            .filter((_, i) => i % step === 0)
            .map(Math.abs)
            .sort();
        const high = sizes[Math.floor((sizes.length - 1) * kMaxShare)] || 1e-6;
        return { low: -high, high };
    }
    return {
        low: values.reduce((a, b) => Math.min(a, b), Infinity),
        high: values.reduce((a, b) => Math.max(a, b), -Infinity),
    };
}

const known = new WeakMap<Geometry, Map<Coloring, Range | null>>();

/** The range of the values of a geometry; null if it has no values. */
export function rangeOf(geometry: Geometry, color: Coloring): Range | null {
    const ranges = known.get(geometry) ?? new Map<Coloring, Range | null>();
    known.set(geometry, ranges);
    let range = ranges.get(color);
    if (range === undefined) {
        const values = valuesOf(geometry, color);
        range = values && values.length > 0 ? rangeOfValues(values, color) : null;
        ranges.set(color, range);
    }
    return range;
}

/** The range that contains both. */
export function union(a: Range | null, b: Range | null): Range | null {
    return a && b ? { low: Math.min(a.low, b.low), high: Math.max(a.high, b.high) } : (a ?? b);
}
