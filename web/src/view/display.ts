// How the view draws what there is: settings of the user, kept by the browser where they suit every scene.
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

/** A plane that cuts away what lies on its positive side. */
export interface Section {
    on: boolean;
    axis: Axis;
    at: number; // [m] along the axis
    flipped: boolean;
}

/** A plane on which the field of a solid is seen. */
export interface Slice {
    on: boolean;
    solid: string; // its name; empty: none
    axis: Axis;
    at: number; // [m] along the axis
    lines: number; // about so many lines of equal value, besides that of the surface
}

/** What colours stand for at the moment. */
export interface Legend extends Range {
    title: string;
    unit: string;
    map: ColorMap;
    mark?: { value: number; label: string }; // a number that has a line of its own
}

/** A place where a surface crosses itself. */
export interface Crossing {
    at: Point;
    radius: number; // [m] that the faces reach from there
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
    hour: Signal<number>; // of the sun, in [5, 19]
    north: Signal<number>; // [degree] by which the sky is turned
    parallel: Signal<boolean>;
    section: Signal<Section>;
    slice: Signal<Slice>;
    crossings: Signal<readonly Crossing[]>; // seen with the colour of that name
    crossing: Signal<number>; // the one that is looked at; -1: none
    legend: Signal<Legend | null>;
    sliceLegend: Signal<Legend | null>;
    scale: Signal<{ pixels: number; metres: number }>; // of the bar in the corner
    axes: Signal<readonly Point[]>; // where x, y and z point: right, up and towards the eye, each in [-1, 1]
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
