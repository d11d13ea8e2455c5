// Initial values for the size of an object, and the ranges of sliders around them.
import type { Argument, Point, SceneObject } from "../../protocol";
import { roundStep, snapped } from "../../tools/kit/vector";
import { pointWord } from "../../tools/kit/words";
import type { Values } from "../../script/values";

const kBallInBox = Math.PI / 6; // crowns fill about this fraction of their bounding box
const kMaxEven = 360; // wider ranges have a logarithmic slider
const kMinShare = 0.02; // fraction of a linear slider below which the usual value could hardly be selected
const kReach = 20; // factor around the usual value, in both directions

/** Rounds to two digits, which is sufficient for sliders and suggestions. */
export function rounded(value: number, digits = 2): number {
    return Number(value.toPrecision(digits));
}

/** The mean distance of a number of points inside these bounds. */
export function spacingIn([x0, y0, z0, x1, y1, z1]: SceneObject["bounds"], count: number): number {
    const volume = kBallInBox * Math.max(x1 - x0, 1e-3) * Math.max(y1 - y0, 1e-3) * Math.max(z1 - z0, 1e-3);
    return Math.cbrt(volume / Math.max(count, 1));
}

/** The position of a tree for a crown: below its centre, on the ground, or at its base if it extends below the ground. */
export function rootBelow([x0, y0, z0, x1, y1]: SceneObject["bounds"]): Point {
    const step = roundStep(Math.max(x1 - x0, y1 - y0, 1e-6) / 40); // positions of trees are rounded to practical values
    const near = (value: number) => rounded(snapped(value, step), 6);
    return [near((x0 + x1) / 2), near((y0 + y1) / 2), near(Math.min(z0, 0))];
}

/** Radii and step of growth into points, from their mean distance. */
export function growthValues(bounds: SceneObject["bounds"], count: number): Values {
    const spacing = spacingIn(bounds, count);
    return {
        root: [pointWord(rootBelow(bounds))],
        influence_radius: [String(rounded(4 * spacing))],
        kill_radius: [String(rounded(0.55 * spacing))],
        step: [String(rounded(0.27 * spacing))],
    };
}

/** A radius of tips that suits segments of a length. */
export function tipRadius(step: number): number {
    return rounded(step / 11);
}

export interface Slider {
    steps: number;
    toStep(value: number): number;
    toValue(step: number): number;
}

/** A slider for a number. Wide ranges are logarithmic around the usual value; null if a slider is not useful. */
export function sliderOf({ type, low, high, name }: Argument, usual: number): Slider | null {
    if (low === undefined || high === undefined || name === "seed" || name === "max_memory") {
        return null;
    }
    const whole = type === "whole";
    const round = (value: number) => (whole ? Math.round(value) : rounded(value, 3));
    const within = (step: number, steps: number) => Math.min(Math.max(Math.round(step), 0), steps);
    const isLow = Math.abs(usual) > 0 && usual - low < (high - low) * kMinShare;
    if (high - low <= kMaxEven && !isLow) {
        const steps = whole && high - low <= 100 ? high - low : 200;
        return {
            steps,
            toStep: (value) => within(((value - low) / (high - low)) * steps, steps),
            toValue: (step) => round(low + ((high - low) * step) / steps),
        };
    }
    const middle = Math.min(Math.max(Math.abs(usual), whole ? 10 : 1e-3, low), high);
    const [from, to] = [Math.max(middle / kReach, low, whole ? 1 : 0), Math.min(middle * kReach, high)];
    const hasZero = low <= 0;
    const steps = 200;
    const first = hasZero ? 1 : 0; // the step before represents 0
    return {
        steps,
        toStep: (value) => (hasZero && value <= 0 ? 0 : within(first + (Math.log(value / from) / Math.log(to / from)) * (steps - first), steps)),
        toValue: (step) => (step < first ? 0 : round(from * (to / from) ** ((step - first) / (steps - first)))),
    };
}
