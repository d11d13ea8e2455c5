// Some commands of the schema of the engine, with every kind of argument.
import type { Argument, Command, State } from "../../src/protocol";
import { piecesOf } from "../../src/script/pieces";
import { kEmptyState } from "../../src/store";

function argument(name: string, type: Argument["type"], more: Partial<Argument> = {}): Argument {
    return { name, help: `Meaning of ${name}.`, type, positional: false, required: false, repeats: false, ...more };
}

const first = { positional: true, required: true };
const newName = (kind: string) => ({ ...first, help: `Name of the new ${kind}.` });
const metres = { unit: "metre", low: -1e6, high: 1e6 };

function command(name: string, args: Argument[], more: Partial<Command> = {}): Command {
    return { name, aliases: [], group: "Commands", help: `Does ${name}.`, example: name, arguments: args, ...more };
}

export const schema: Command[] = [
    command(
        "sphere",
        [
            argument("name", "new_name", newName("solid")),
            argument("center", "tuple", { sizes: [3], default: "0,0,0", ...metres }),
            argument("radius", "number", { default: "1", unit: "metre", low: 1e-5, high: 1e5 }),
            argument("law", "choice", { choices: ["cube", "soft"], default: "cube" }),
        ],
        { group: "Primitives" },
    ),
    command("scale", [
        argument("solid", "object", { ...first, kind: "solid", also: ["skeleton"] }),
        argument("factor", "tuple", { ...first, sizes: [1, 3] }),
        argument("center", "tuple", { sizes: [3], default: "0,0,0" }),
        argument("kind", "choice", { choices: ["solid", "skeleton"] }),
    ]),
    command("translate", [
        argument("solid", "object", { ...first, kind: "solid", also: ["skeleton"] }),
        argument("by", "tuple", { ...first, sizes: [3], ...metres }),
        argument("kind", "choice", { choices: ["solid", "skeleton"] }),
    ]),
    command("union", [argument("parts", "object", { ...first, kind: "solid", repeats: true }), argument("result", "new_name", newName("solid"))], {
        group: "Combining",
    }),
    command("polyline", [
        argument("name", "new_name", newName("solid")),
        argument("points", "tuple", { ...first, sizes: [3], repeats: true }),
        argument("closed", "flag", { default: "false" }),
    ]),
    command("skin", [
        argument("name", "new_name", newName("solid")),
        argument("path", "object", { ...first, kind: "path" }),
        argument("sections", "section", { ...first, repeats: true }),
    ]),
    command(
        "pointset generate",
        [
            argument("solid", "object", { ...first, kind: "solid" }),
            argument("pattern", "choice", { positional: true, choices: ["poisson_disk", "clustered", "uniform"], default: "poisson_disk" }),
            argument("properties", "properties", { positional: true }),
            argument("count", "whole", { default: "1000", low: 0, high: 1e8 }),
            argument("kernel", "tuple", { sizes: [2], repeats: true }),
            argument("seed", "whole", { default: "0", low: 0, high: 2147483647 }),
            argument("name", "new_name", { default: "@solid", help: "Name of the new points." }),
        ],
        { aliases: ["pointset gen"], group: "Points" },
    ),
    command(
        "grow",
        [
            argument("tree", "new_name", newName("skeleton")),
            argument("points", "object", { ...first, kind: "points" }),
            argument("root", "tuple", { sizes: [3, 6], repeats: true, default: "0,0,0" }),
            argument("step", "number", { default: "0.1", unit: "metre", low: 1e-6, high: 1e4 }),
        ],
        { group: "Trees" },
    ),
    command("mesh", [
        argument("tree", "object", { ...first, kind: "skeleton" }),
        argument("name", "new_name", { positional: true, default: "@tree", help: "Name of the new mesh." }),
        argument("levels", "whole", { default: "2", low: 0, high: 6 }),
        argument("uv", "choice", { choices: ["none", "bark", "atlas"], default: "none" }),
        argument("material", "object", { kind: "material" }),
        argument("displace", "flag", { default: "false" }),
    ]),
    command("material", [
        argument("name", "new_name", newName("material")),
        argument("species", "choice", { ...first, choices: ["oak", "pine"] }),
        argument("width", "whole", { low: 1, high: 4096 }),
    ]),
    command("loadmaterial", [argument("name", "new_name", newName("material")), argument("file", "input_file", first)]),
    command("edit prune", [
        argument("tree", "object", { ...first, kind: "skeleton" }),
        argument("nodes", "selection", { positional: true, default: "all" }),
        argument("length", "number", { default: "0", unit: "metre", low: 0, high: 1e6 }),
    ]),
    command("copy", [
        argument("name", "object", { ...first, kind: "any" as "solid" }),
        argument("copy", "new_name", { ...first, help: "The other name." }),
        argument("kind", "choice", { choices: ["solid", "points", "skeleton", "mesh"] }),
    ]),
    command("delete", [
        argument("names", "object", { ...first, kind: "any" as "solid", repeats: true }),
        argument("kind", "choice", { choices: ["solid", "points", "skeleton", "mesh"] }),
    ]),
    command("save", [argument("name", "object", { ...first, kind: "any" as "solid" }), argument("file", "output_file", first)]),
];

export function called(name: string): Command {
    const found = schema.find((one) => one.name === name);
    if (!found) {
        throw new Error(`no command ${name}`);
    }
    return found;
}

/** A state in which all statements have run. */
export function stateOf(text: string, objects: readonly [string, number][] = []): State {
    const statements = piecesOf(text).map(({ text: one, line }) => ({ text: one, line, message: "" }));
    return {
        ...kEmptyState,
        statements,
        ran: statements.length,
        objects: objects.map(([id, statement]) => {
            const [kind, name] = id.split(":");
            return { kind: kind as "solid", name, version: 1, statement, bounds: [0, 0, 0, 1, 1, 1], count: 3, unit: "parts" };
        }),
    };
}
