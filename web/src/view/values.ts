// What colours stand for: the numbers of a geometry, and how far they reach.
import type { Geometry } from "../app";
import type { ColorMap, Range } from "./colors";
import type { Coloring } from "./display";

interface Meaning {
    title: string;
    unit: string;
    map: ColorMap;
}

/** Of the colourings that paint numbers. */
export const kMeanings: Partial<Record<Coloring, Meaning>> = {
    radius: { title: "Radius", unit: "m", map: "even" },
    order: { title: "Order of branching", unit: "", map: "even" },
    deviation: { title: "Deviation", unit: "radii", map: "diverging" },
    evidence: { title: "Measured share of the radius", unit: "", map: "even" },
};

/** What the engine has to send for a colouring; of the others the page knows the numbers, or none are needed. */
export function colorAsked(color: Coloring, form: "axes" | "surface"): Coloring {
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

const kMostShare = 0.98; // of the vertices' deviations that the colours tell apart
const kSample = 20000;

function rangeOfValues(values: Float32Array, color: Coloring): Range {
    if (color === "evidence") {
        return { low: 0, high: 1 };
    }
    if (color === "deviation") {
        const step = Math.ceil(values.length / kSample) || 1;
        const sizes = values.filter((_, i) => i % step === 0).map(Math.abs).sort();
        const high = sizes[Math.floor((sizes.length - 1) * kMostShare)] || 1e-6;
        return { low: -high, high };
    }
    return {
        low: values.reduce((a, b) => Math.min(a, b), Infinity),
        high: values.reduce((a, b) => Math.max(a, b), -Infinity),
    };
}

const known = new WeakMap<Geometry, Map<Coloring, Range | null>>();

/** How far the numbers of a geometry reach; null where it has none. */
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

/** What holds both. */
export function union(a: Range | null, b: Range | null): Range | null {
    return a && b ? { low: Math.min(a.low, b.low), high: Math.max(a.high, b.high) } : (a ?? b);
}
