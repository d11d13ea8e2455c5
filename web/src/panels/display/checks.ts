// Results of checks of surfaces, kept until the surfaces change.
import { signal } from "@preact/signals-core";
import type { App } from "../../app";
import type { ObjectName, Point, SceneObject } from "../../protocol";
import { type CrossingPlace, crossingPlaces, type Figures } from "./figures";

export interface Check {
    object: ObjectName;
    version: number; // version of the object at the time of the check
    good: boolean;
    verdict: string;
    figures: Figures;
    places: CrossingPlace[];
}

/** The last check. */
export const lastCheck = signal<Check | null>(null);
/** The object being checked; null if no check is running. */
export const checking = signal<ObjectName | null>(null);

/** The object to check: the selected skeleton or mesh, otherwise the newest mesh, otherwise the newest skeleton. */
export function checkedObject({ store }: Pick<App, "store">): SceneObject | undefined {
    const { object } = store.selection.value;
    const { objects } = store.state.value;
    const selected = objects.find(({ kind, name }) => kind === object?.kind && name === object.name);
    if (selected?.kind === "skeleton" || selected?.kind === "mesh") {
        return selected;
    }
    const newest = (wanted: string) =>
        objects
            .filter(({ kind }) => kind === wanted)
            .reduce<SceneObject | undefined>((last, object) => (last && last.statement > object.statement ? last : object), undefined);
    return newest("mesh") ?? newest("skeleton");
}

/** Returns whether the check is of the current version of the object. */
export function isOf(check: Check | null, object: SceneObject | undefined): boolean {
    return check !== null && check.object.kind === object?.kind && check.object.name === object.name && check.version === object.version;
}

interface Reply {
    figures: Figures;
    good: boolean;
    verdict: string;
    crossings: Point[];
}

export async function check(app: App, object: SceneObject): Promise<void> {
    const { kind, name, version } = object;
    checking.value = { kind, name };
    try {
        const { figures, good, verdict, crossings } = await app.engine.request<Reply>("check", { kind, name });
        const places = crossingPlaces(figures, crossings);
        lastCheck.value = { object: { kind, name }, version, good, verdict, figures, places };
        app.view.display.crossings.value = places;
        app.view.display.crossing.value = -1;
    } catch (error) {
        app.store.notify(`The check of ${name} failed: ${(error as Error).message}`, "error");
    } finally {
        checking.value = null;
    }
}

/** Runs the check if there is no current one, so that crossings can be marked. */
export async function checkWhereUnknown(app: App): Promise<void> {
    const object = checkedObject(app);
    if (!object) {
        app.store.notify("There is no skeleton or mesh with crossings to mark.", "warning");
    } else if (!isOf(lastCheck.peek(), object) && checking.peek() === null) {
        await check(app, object);
    }
}

/** Moves a crossing to the centre of the view, and marks it. */
export function showPlace(app: App, places: readonly CrossingPlace[], at: number): void {
    const { display } = app.view;
    display.color.value = "crossings";
    display.crossing.value = at;
    const { objects } = app.store.state.peek();
    const size = Math.max(...objects.map(({ bounds }) => bounds[5] - bounds[2]), 1e-3);
    app.view.frameAround(places[at].at, places[at].radius > 0 ? places[at].radius * 4 : size / 20);
}
