// The source skeletons of meshes.
import type { Store } from "../app";
import type { State } from "../protocol";
import { meshSource } from "../script/names";
import { readCall } from "../script/values";

const kKnown = new WeakMap<State, ReadonlyMap<string, string>>();

/** The skeleton of each mesh, by name: for meshes that were created from a skeleton, if neither has changed since. */
export function meshSources(store: Store): ReadonlyMap<string, string> {
    const state = store.state.peek();
    const schema = store.schema.peek();
    const known = kKnown.get(state);
    if (known || schema.length === 0) {
        return known ?? new Map();
    }
    const sources = new Map<string, string>();
    for (const mesh of state.objects.filter(({ kind }) => kind === "mesh")) {
        const name = meshSource(schema, state.statements[mesh.statement]?.text ?? "", mesh.name);
        const skeleton = name === null ? undefined : store.find("skeleton", name);
        if (skeleton && skeleton.statement < mesh.statement) {
            sources.set(mesh.name, skeleton.name);
        }
    }
    kKnown.set(state, sources);
    return sources;
}

/** The material of the mesh of a skeleton; undefined if it has none. */
export function barkOf(store: Store, skeleton: string): string | undefined {
    const { objects, statements } = store.state.peek();
    const sources = meshSources(store);
    return objects
        .filter(({ kind, name }) => kind === "mesh" && sources.get(name) === skeleton)
        .flatMap(({ statement }) => readCall(store.schema.peek(), statements[statement]?.text ?? "")?.values.material ?? [])
        .find((material) => store.find("material", material));
}
