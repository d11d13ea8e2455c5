// What the engine found of surfaces, kept until they change.
import { signal } from "@preact/signals-core";
import type { App } from "../../app";
import type { ObjectName, Point, SceneObject } from "../../protocol";
import { type CrossingPlace, crossingPlaces, type Figures } from "./figures";

export interface Check {
    object: ObjectName;
    version: number; // of the object, then
    good: boolean;
    verdict: string;
    figures: Figures;
    places: CrossingPlace[];
}

/** The last check. */
export const lastCheck = signal<Check | null>(null);
/** What is being checked; null: nothing. */
export const checking = signal<ObjectName | null>(null);

/** What a check is about: the skeleton or mesh that is selected, else the newest mesh, else the newest skeleton. */
export function checkedObject({ store }: Pick<App, "store">): SceneObject | undefined {
    const { object } = store.selection.value;
    const { objects } = store.state.value;
    const selected = objects.find(({ kind, name }) => kind === object?.kind && name === object.name);
    if (selected?.kind === "skeleton" || selected?.kind === "mesh") {
        return selected;
    }
    const newest = (wanted: string) => objects.filter(({ kind }) => kind === wanted).reduce<SceneObject | undefined>(
        (last, object) => (last && last.statement > object.statement ? last : object),
        undefined,
    );
    return newest("mesh") ?? newest("skeleton");
}

/** Whether the check is of the object as it is now. */
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
        app.store.say(`The check of ${name} ended: ${(error as Error).message}`, "error");
    } finally {
        checking.value = null;
    }
}

/** Checks what was not checked yet, so that crossings can be marked. */
export async function checkWhereUnknown(app: App): Promise<void> {
    const object = checkedObject(app);
    if (!object) {
        app.store.say("There is no skeleton or mesh whose crossings could be marked.", "warning");
    } else if (!isOf(lastCheck.peek(), object) && checking.peek() === null) {
        await check(app, object);
    }
}

/** Brings a place of crossing into the middle of the picture, and marks it. */
export function showPlace(app: App, places: readonly CrossingPlace[], at: number): void {
    const { display } = app.view;
    display.color.value = "crossings";
    display.crossing.value = at;
    const { objects } = app.store.state.peek();
    const size = Math.max(...objects.map(({ bounds }) => bounds[5] - bounds[2]), 1e-3);
    app.view.frameAround(places[at].at, places[at].radius > 0 ? places[at].radius * 4 : size / 20);
}
