// Objects that a line has made: the state that has them may come behind the answer to the line.
import type { App } from "../../app";
import type { SceneObject } from "../../protocol";

const kPatience = 2000; // [ms]

/** Waits until there is an object as wanted, and selects it. */
export async function selectWhenThere(app: App, wanted: (object: SceneObject) => boolean): Promise<SceneObject | undefined> {
    const { state, selection } = app.store;
    let stop: (() => void) | undefined;
    await Promise.race([
        new Promise<void>((done) => {
            stop = state.subscribe(({ objects }) => objects.some(wanted) && done());
        }),
        new Promise((done) => setTimeout(done, kPatience)),
    ]);
    stop?.();
    const object = state.peek().objects.find(wanted);
    if (object) {
        selection.value = { ...selection.peek(), object: { kind: object.kind, name: object.name }, nodes: [] };
    }
    return object;
}
