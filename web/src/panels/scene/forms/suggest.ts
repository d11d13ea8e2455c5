// Initial values of the form of a command: a free name, and the most probable objects.
import type { App } from "../../../app";
import type { Argument, Command, Kind, ObjectName, SceneObject } from "../../../protocol";
import { kindsOf } from "../../../script/commands";
import { newKind } from "../../../script/names";
import { defaultWord, type Values } from "../../../script/values";

const kBases: Partial<Record<Kind, string>> = { skeleton: "tree", points: "points", path: "path", profile: "profile", material: "bark" };

function likely(objects: readonly SceneObject[], kinds: readonly Kind[], selected: ObjectName | null): string | undefined {
    if (selected && kinds.includes(selected.kind)) {
        return selected.name;
    }
    const fitting = kinds.map((kind) => objects.filter((object) => object.kind === kind)).find((some) => some.length > 0) ?? [];
    return fitting.reduce<SceneObject | undefined>((newest, one) => (!newest || one.statement > newest.statement ? one : newest), undefined)?.name;
}

function newName(app: App, command: Command, argument: Argument): string {
    const kind = newKind(argument)[0];
    const word = command.name.split(" ").at(-1) ?? "";
    return app.store.freeName((kind && kBases[kind]) || word);
}

/** Values of required arguments that have no value yet. */
export function suggested(app: App, command: Command, given: Values): Values {
    const { objects } = app.store.state.peek();
    const { object } = app.store.selection.peek();
    const values: Record<string, readonly string[]> = {};
    for (const argument of command.arguments) {
        if (!argument.required || given[argument.name] || defaultWord(argument, given) !== "") {
            continue;
        }
        const kinds = kindsOf(argument);
        const name = argument.type === "new_name" ? newName(app, command, argument) : argument.type === "object" ? likely(objects, kinds, object) : undefined;
        if (name !== undefined) {
            values[argument.name] = [name];
        }
    }
    return values;
}
