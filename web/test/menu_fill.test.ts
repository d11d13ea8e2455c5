// Menu items: their groups, and the text inserted into their lines.
import assert from "node:assert/strict";
import { test } from "node:test";
import { answerError, argumentsOf, filled, requestedKinds, partsOf } from "../src/panels/menu/fill";
import { type MenuItem, menusOf, settingOf } from "../src/panels/menu/items";
import type { Argument, Command } from "../src/protocol";

function argument(name: string, type: Argument["type"], more: Partial<Argument> = {}): Argument {
    return { name, help: "", type, positional: true, required: true, repeats: false, ...more };
}

function command(name: string, ...args: Argument[]): Command {
    return { name, aliases: [], group: "", help: "", example: "", arguments: args };
}

const radius = argument("radius", "number", { positional: false, required: false, low: 0.001, high: 10, unit: "metre" });
const kSchema: Command[] = [
    command("sphere", argument("name", "new_name"), radius),
    command("mesh", argument("tree", "object", { kind: "skeleton" }), argument("name", "new_name", { required: false })),
    command("translate", argument("name", "object"), argument("by", "tuple", { sizes: [3] })),
    command("save", argument("name", "object"), argument("file", "output_file")),
    command(
        "edit bend",
        argument("tree", "object", { kind: "skeleton" }),
        argument("nodes", "selection"),
        argument("angle", "number", { low: -180, high: 180 }),
    ),
];

function fill(line: string, answers: string[] = [], object = "oak"): string {
    return filled(partsOf(line), { object, answers }, kSchema);
}

test("the selected object and the answers are inserted into a line; the engine chooses new names", () => {
    assert.equal(fill("sphere ${new crown} radius=${ask Radius, 2}", [" 3 "]), "sphere ${new crown} radius=3");
    assert.equal(fill("mesh ${object} ${object}_skin"), "mesh oak oak_skin");
});

test("expressions of scenes and escaped text are not changed", () => {
    const line = "sphere ${crown} radius=${height / 3} # $${object} ${objects} ${asks 1}";
    assert.equal(fill(line), line);
});

test("answers with blanks are quoted as one word, and numbers are not quoted", () => {
    assert.equal(fill("save ${object} ${ask File, tree.swc}", ["my tree.swc"]), 'save oak "my tree.swc"');
    assert.equal(fill("translate ${object} ${ask By, 0 0 1}", ["0 0 2"]), "translate oak 0 0 2");
    assert.equal(fill("save ${object} ${ask File, a}", ["${name}.swc"]), "save oak ${name}.swc");
});

test("a question has a label, a proposed value and its argument", () => {
    const parts = partsOf("edit bend ${object} ${ask Which nodes, subtree(12)} ${ask Angle, 20}");
    const asks = parts.filter((part) => part.is === "ask");
    assert.deepEqual(
        asks.map((part) => [part.label, part.value]),
        [
            ["Which nodes", "subtree(12)"],
            ["Angle", "20"],
        ],
    );
    const partArguments = argumentsOf(kSchema, parts);
    assert.deepEqual(
        parts.map((part, at) => (part.is === "text" ? "" : partArguments[at]?.name)),
        ["", "tree", "", "nodes", "", "angle"],
    );
    assert.deepEqual(partsOf("sphere a radius=${ask Radius}").at(-1), { is: "ask", label: "Radius", value: "" });
});

test("an item requires an object of a kind that its command accepts", () => {
    assert.deepEqual(requestedKinds(kSchema, "mesh ${object}"), ["skeleton"]);
    assert.equal(requestedKinds(kSchema, "translate ${object} 0 0 1")?.length, 7);
    assert.equal(requestedKinds(kSchema, "no_such_command ${object}")?.length, 7);
    assert.equal(requestedKinds(kSchema, "sphere ${new crown}"), null);
});

test("answers are checked before the line runs", () => {
    const objects = [{ kind: "skeleton" as const, name: "oak" }];
    const [, bend] = [kSchema[1], kSchema[4]];
    const wrong = (answer: string, of: Argument | undefined) => answerError(answer, of, objects);
    assert.equal(wrong("0.5", radius), "");
    assert.match(wrong("20", radius), /from 0.001 to 10/);
    assert.match(wrong("many", radius), /number/);
    assert.match(wrong(" ", undefined), /value/);
    assert.equal(wrong("${height / 3}", radius), "");
    assert.equal(wrong("0 0,1", kSchema[2].arguments[1]), "");
    assert.match(wrong("0,1", kSchema[2].arguments[1]), /3 numbers/);
    assert.equal(wrong("oak", bend.arguments[0]), "");
    assert.match(wrong("elm", bend.arguments[0]), /no skeleton elm/);
    assert.match(wrong("1st", kSchema[0].arguments[0]), /letter/);
    const choice = argument("method", "choice", { choices: ["quads", "quick", "tetrahedra"] });
    assert.equal(wrong("t", choice), "");
    assert.equal(wrong("quads", choice), "");
    assert.match(wrong("qu", choice), /one of quads/);
    assert.match(wrong("2.5", argument("count", "whole")), /whole/);
});

test("menus are in the order of their first items, without redundant separators", () => {
    const item = (menu: string, label: string, does: MenuItem["does"] = "page"): MenuItem => ({ number: 0, menu, label, does, text: "" });
    const menus = menusOf([
        item("File", "", "separator"),
        item("File", "New..."),
        item("Crown", "Ball"),
        item("File", "", "separator"),
        item("File", "", "separator"),
        item("File", "Save"),
        item("File", "", "separator"),
    ]);
    assert.deepEqual(
        menus.map(({ title, items }) => [title, ...items.map(({ label, does }) => (does === "separator" ? "-" : label))]),
        [
            ["File", "New…", "-", "Save"],
            ["Crown", "Ball"],
        ],
    );
});

test("settings consist of a command, an argument and a value", () => {
    assert.deepEqual(settingOf("grow.kill_radius 0.3"), { key: "grow.kill_radius", value: "0.3" });
    assert.deepEqual(settingOf(" pointset generate.count  500 "), { key: "pointset generate.count", value: "500" });
    assert.equal(settingOf("grow.kill_radius"), null);
});
