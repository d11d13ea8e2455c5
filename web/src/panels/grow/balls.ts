// The balls of influence and kill radius in the view: at the roots, at the pointer, at some of the points.
import type { App, Geometry } from "../../app";
import type { Command, Point } from "../../protocol";
import { Overlay, kColors } from "../../tools/kit/overlay";
import type { Values } from "../../script/values";
import { numberOf } from "./values";

const kSamples = 3;

/** Number of points inside a ball. */
export function countWithin(position: ArrayLike<number>, origin: Point, at: Point, radius: number): number {
    let count = 0;
    for (let i = 0; i + 2 < position.length; i += 3) {
        const [x, y, z] = [position[i] + origin[0] - at[0], position[i + 1] + origin[1] - at[1], position[i + 2] + origin[2] - at[2]];
        count += x * x + y * y + z * z < radius * radius ? 1 : 0;
    }
    return count;
}

/** A sample of the points, spread over the set. */
export function samplesOf(position: ArrayLike<number>, origin: Point, count = kSamples): Point[] {
    const points = Math.floor(position.length / 3);
    return Array.from({ length: Math.min(count, points) }, (_, n) => {
        const i = Math.floor(((n + 0.5) * points) / Math.min(count, points));
        return [0, 1, 2].map((c) => position[3 * i + c] + origin[c]) as Point;
    });
}

/** The positions in root=; if missing, the base of the scene. */
export function rootsOf(values: Values): Point[] {
    const points = (values.root ?? ["0,0,0"]).map((word) => word.split(",").slice(0, 3).map(Number));
    return points.filter((point) => point.length === 3 && point.every(Number.isFinite)) as Point[];
}

export interface Reach {
    at: "pointer" | "root";
    pulling: number; // points within the radius of influence
    removed: number; // points within the kill radius
    all: number;
}

/** The number of points inside the radii of a growth, counted at the pointer or otherwise at its first root. */
export function reachOf(geometry: Geometry, command: Command, values: Values, pointer: Point | null): Reach {
    const position = geometry.arrays.position as Float32Array;
    const { origin } = geometry.header;
    const at = pointer ?? rootsOf(values)[0] ?? [0, 0, 0];
    const within = (name: string) => countWithin(position, origin, at, numberOf(command, values, name));
    return {
        at: pointer ? "pointer" : "root",
        pulling: within("influence_radius"),
        removed: within("kill_radius"),
        all: position.length / 3,
    };
}

const kRadii = ["influence_radius", "kill_radius", "step"] as const;
export type RadiusName = (typeof kRadii)[number];

export function isRadius(name: string): name is RadiusName {
    return (kRadii as readonly string[]).includes(name);
}

/** Shown while a field of a radius is in use. */
export class Balls {
    private readonly overlay: Overlay;

    constructor(app: App) {
        this.overlay = new Overlay(app);
    }

    show(geometry: Geometry | undefined, command: Command, values: Values, name: RadiusName, pointer: Point | null): void {
        const position = (geometry?.arrays.position ?? []) as ArrayLike<number>;
        const radius = numberOf(command, values, name);
        const color = name === "kill_radius" ? kColors.cut : name === "step" ? kColors.plain : kColors.grow;
        const places = [...rootsOf(values), ...(pointer ? [pointer] : samplesOf(position, geometry?.header.origin ?? [0, 0, 0]))];
        this.overlay.clear();
        for (const place of places) {
            this.overlay.ball(place, radius, color);
        }
        this.overlay.dots(places, color, 6);
    }

    clear(): void {
        this.overlay.clear();
    }

    stop(): void {
        this.overlay.stop();
    }
}
