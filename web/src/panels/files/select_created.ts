// Objects created by a line: the state with them may arrive after the response to the line.
import type { App } from "../../app";
import type { SceneObject } from "../../protocol";

const kArrivalTimeout = 2000; // [ms]

/** Waits until a matching object exists, and selects it. */
export async function selectWhenCreated(app: App, wanted: (object: SceneObject) => boolean): Promise<SceneObject | undefined> {
    const { state, selection } = app.store;
    let stop: (() => void) | undefined;
    await Promise.race([
        new Promise<void>((done) => {
            stop = state.subscribe(({ objects }) => objects.some(wanted) && done());
        }),
        new Promise((done) => setTimeout(done, kArrivalTimeout)),
    ]);
    stop?.();
    const object = state.peek().objects.find(wanted);
    if (object) {
        selection.value = { ...selection.peek(), object: { kind: object.kind, name: object.name }, nodes: [] };
    }
    return object;
}
