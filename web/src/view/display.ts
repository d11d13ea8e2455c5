// Display settings of the view; those that suit every scene are stored in the browser.
import { signal, type Signal } from "@preact/signals-core";
import type { Point } from "../protocol";
import { setting } from "../settings";
import { kPresets, type Preset } from "./camera/presets";
import type { ColorMap, Range } from "./colors";

export type Coloring = "plain" | "radius" | "order" | "deviation" | "evidence" | "crossings";
export type SkeletonForm = "surface" | "tubes" | "lines";
export type SolidForm = "auto" | "opaque" | "glass";

export const kColorings: readonly Coloring[] = ["plain", "radius", "order", "deviation", "evidence", "crossings"];
export const kSkeletonForms: readonly SkeletonForm[] = ["surface", "tubes", "lines"];
export const kSolidForms: readonly SolidForm[] = ["auto", "opaque", "glass"];

export type Axis = "x" | "y" | "z";

/** A plane that hides everything on its positive side. */
export interface Section {
    on: boolean;
    axis: Axis;
    at: number; // [m] along the axis
    flipped: boolean;
}

/** A plane that shows the field of a solid. */
export interface Slice {
    on: boolean;
    solid: string; // name of the solid; empty: no slice
    axis: Axis;
    at: number; // [m] along the axis
    lines: number; // approximate number of isolines, in addition to the surface line
}

/** The current meaning of the colours. */
export interface Legend extends Range {
    title: string;
    unit: string;
    map: ColorMap;
    mark?: { value: number; label: string }; // a value with its own line
}

/** A self-intersection of a surface. */
export interface Crossing {
    at: Point;
    radius: number; // [m] distance to which the intersecting faces extend
}

export interface Display {
    preset: Signal<Preset>;
    color: Signal<Coloring>;
    skeletons: Signal<SkeletonForm>;
    solids: Signal<SolidForm>;
    wireframe: Signal<boolean>;
    cage: Signal<boolean>;
    bones: Signal<boolean>;
    points: Signal<boolean>;
    pointSize: Signal<number>; // [px]
    grid: Signal<boolean>;
    shadow: Signal<boolean>;
    hour: Signal<number>; // hour of the sun, in [5, 19]
    north: Signal<number>; // [degree] rotation of the sky
    parallel: Signal<boolean>;
    section: Signal<Section>;
    slice: Signal<Slice>;
    crossings: Signal<readonly Crossing[]>; // visible when colours show crossings
    crossing: Signal<number>; // index of the crossing in focus; -1: no crossing
    legend: Signal<Legend | null>;
    sliceLegend: Signal<Legend | null>;
    scale: Signal<{ pixels: number; metres: number }>; // of the scale bar in the corner
    axes: Signal<readonly Point[]>; // directions of x, y and z: right, up and towards the camera, each in [-1, 1]
}

export function createDisplay(): Display {
    return {
        preset: setting<Preset>("preset", "blender", kPresets),
        color: signal<Coloring>("plain"),
        skeletons: setting<SkeletonForm>("skeletons", "surface", kSkeletonForms),
        solids: setting<SolidForm>("solids", "auto", kSolidForms),
        wireframe: signal(false),
        cage: signal(false),
        bones: signal(false),
        points: setting("points", true),
        pointSize: setting("pointsize", 3),
        grid: setting("grid", true),
        shadow: setting("shadow", true),
        hour: setting("hour", 10),
        north: setting("north", 0),
        parallel: signal(false),
        section: signal<Section>({ on: false, axis: "y", at: 0, flipped: false }),
        slice: signal<Slice>({ on: false, solid: "", axis: "y", at: 0, lines: 8 }),
        crossings: signal<readonly Crossing[]>([]),
        crossing: signal(-1),
        legend: signal(null),
        sliceLegend: signal(null),
        scale: signal({ pixels: 0, metres: 1 }),
        axes: signal<readonly Point[]>([]),
    };
}
