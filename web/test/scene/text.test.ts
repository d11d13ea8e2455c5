// Statements as text: their words, their values, and back again.
import assert from "node:assert/strict";
import { test } from "node:test";
import fc from "fast-check";
import { bind, findCommand, kindsOf, usage } from "../../src/script/commands";
import { placesIn, renamed, stepsOf } from "../../src/script/names";
import { linesOf, pieceAt, piecesOf, textOf } from "../../src/script/pieces";
import { unfinished } from "../../src/script/unfinished";
import { defaultWord, lineOf, missing, readCall, type Values, withValue, written } from "../../src/script/values";
import { isComputed, joined, readLine } from "../../src/script/words";
import type { Argument } from "../../src/protocol";
import { called, schema } from "./schema";

test("words have the same positions as in the engine", () => {
    const line = 'save tree "my tree.glb" kind=mesh note="a # b" # end';
    const { words, comment } = readLine(line);
    assert.deepEqual(
        words.map(({ key, text }) => [key, text]),
        [
            ["", "save"],
            ["", "tree"],
            ["", "my tree.glb"],
            ["kind", "mesh"],
            ["note", "a # b"],
        ],
    );
    assert.equal(line.slice(comment), "# end");
    assert.deepEqual(
        words.map(({ from, to }) => line.slice(from, to)),
        ["save", "tree", '"my tree.glb"', "kind=mesh", 'note="a # b"'],
    );
    assert.equal(line.slice(words[4].value, words[4].to), '"a # b"');
    assert.equal(readLine("sphere a#b").words[1].text, "a#b");
    assert.equal(readLine('save t "open').open, true);
    assert.deepEqual(
        readLine("sphere x center=0,0,${0.7 * height} radius=${h / 3}").words.map(({ text }) => text),
        ["sphere", "x", "0,0,${0.7 * height}", "${h / 3}"],
    );
    assert.equal(readLine('a "q\\"x\\\\"').words[1].text, 'q"x\\');
    assert.equal(isComputed("$${x}"), false);
    assert.equal(isComputed("a${x}"), true);
});

test("concatenated statements are equal to the text", () => {
    const text = "sphere a\n\n# note\nfor i in 1..3\n  if i > 1\n    sphere b${i}\n  end\nend\ngrow t a \\\n  step=0.2\nmesh t\n";
    const pieces = piecesOf(text);
    assert.deepEqual(
        pieces.map(({ line }) => line),
        [1, 2, 3, 4, 9, 11],
    );
    assert.equal(textOf(pieces), text);
    pieces.forEach(({ text: piece, from }) => assert.equal(text.slice(from, from + piece.length), piece));
    assert.equal(pieceAt(pieces, 6), 3);
    assert.equal(pieceAt(pieces, 10), 4);
    assert.equal(pieceAt(pieces, 99), 5);
    assert.equal(piecesOf("repeat 2\n sphere a").at(-1)?.open, true);
    assert.equal(piecesOf("repeat 2\n sphere a\nend").at(-1)?.open, false);
    assert.deepEqual(linesOf(pieces[4].text), [{ text: joined(pieces[4].text), from: 0 }]);
    assert.deepEqual(
        linesOf(pieces[3].text).map((line) => line.text.trim()),
        ["for i in 1..3", "if i > 1", "sphere b${i}", "end", "end"],
    );
});

test("concatenated statements are equal to any text", () => {
    const line = fc.constantFrom("sphere a", "for i in 1..2", "repeat 2", "if 1", "end", "else", "", "# x", "grow t a \\", "forest", "let x = 1");
    fc.assert(
        fc.property(fc.array(line, { maxLength: 12 }), (lines) => {
            const text = lines.map((one) => `${one}\n`).join("");
            assert.equal(textOf(piecesOf(text)), text);
        }),
    );
});

function boundNames(line: string): string[] {
    const { words } = readLine(line);
    const found = findCommand(schema, words);
    assert.ok(found);
    return bind(found.command, words.slice(found.used)).bound.map(({ argument, words: mine }) => `${argument.name}:${mine.map(({ text }) => text).join(" ")}`);
}

test("words are assigned to arguments as in the engine", () => {
    assert.deepEqual(boundNames("union a b c all"), ["parts:a", "parts:b", "parts:c", "result:all"]);
    assert.deepEqual(boundNames("translate a 0 0 5"), ["solid:a", "by:0 0 5"]);
    assert.deepEqual(boundNames("translate a 0,0 5 kind=solid"), ["kind:solid", "solid:a", "by:0,0 5"]);
    assert.deepEqual(boundNames("scale s 50 80 50"), ["solid:s", "factor:50 80 50"]);
    assert.deepEqual(boundNames("pointset gen s poisson count=5"), ["count:5", "solid:s", "pattern:poisson"]);
    assert.equal(findCommand(schema, readLine("pointset").words), null);
    assert.deepEqual(kindsOf(called("copy").arguments[0]).length, 7);
    assert.deepEqual(kindsOf(called("scale").arguments[0]), ["solid", "skeleton"]);
    assert.equal(usage(called("mesh")), "mesh TREE [NAME] [OPTION=VALUE...]");
});

test("words of a statement are parsed to values", () => {
    const call = readCall(schema, "pointset gen crown poisson count=500 kernel=0,1 kernel=1,0 # dense");
    assert.equal(call?.command.name, "pointset generate");
    assert.deepEqual(call?.values, { solid: ["crown"], pattern: ["poisson_disk"], count: ["500"], kernel: ["0,1", "1,0"] });
    assert.equal(call?.comment, "# dense");
    assert.deepEqual(readCall(schema, "translate a 0 0 ${h}")?.values.by, ["0,0,${h}"]);
    assert.deepEqual(readCall(schema, "grow t \\\n crown")?.values, { tree: ["t"], points: ["crown"] });
    for (const other of [
        "repeat 2\n sphere a\nend",
        "let x = 1",
        "spere a",
        "sphere a colour=red",
        'sphere "a',
        "sphere a radius=1 radius=2",
        "# only a comment",
        "mesh t u v",
    ]) {
        assert.equal(readCall(schema, other), null, other);
    }
});

test("formatted lines have only the necessary words, in an order that can be parsed", () => {
    assert.equal(lineOf(called("mesh"), { tree: ["t"], levels: ["1"] }), "mesh t levels=1");
    assert.equal(
        lineOf(called("pointset generate"), { solid: ["s"], properties: ["a b.props"], count: ["5"] }),
        'pointset generate s properties="a b.props" count=5',
    );
    assert.equal(lineOf(called("sphere"), { name: ["s"], radius: ["${h / 2}"] }, "# x"), 'sphere s radius="${h / 2}" # x');
    assert.equal(written("$${x}"), "$${x}");
    assert.equal(written(""), '""');
});

const word = fc.stringMatching(/^[a-z][a-z0-9_.]{0,6}$/);
const number = fc.oneof(fc.integer({ min: -999, max: 999 }), fc.double({ min: -50, max: 50, noNaN: true })).map(String);

function valueFor({ type, sizes = [3], choices = [] }: Argument): fc.Arbitrary<string> {
    switch (type) {
        case "number":
        case "whole":
            return number;
        case "tuple":
            return fc
                .constantFrom(...sizes)
                .chain((n) => fc.array(number, { minLength: n, maxLength: n }))
                .map((parts) => parts.join(","));
        case "flag":
            return fc.constantFrom("true", "false");
        case "choice":
            return fc.constantFrom(...choices);
        case "section":
            return word.map((name) => `${name}@0.5`);
        case "new_name":
        case "object":
            return word;
        default:
            return fc.string({ minLength: 1, maxLength: 12 }).map((text) => text.replace(/[\p{C}]|\$\{/gu, "x"));
    }
}

test("formatted values are parsed without change, for every command", () => {
    for (const command of schema) {
        const given = command.arguments.map((argument) => {
            const some = argument.repeats ? fc.array(valueFor(argument), { minLength: 1, maxLength: 3 }) : valueFor(argument).map((one) => [one]);
            return (argument.required ? some : fc.option(some, { nil: [] })).map((words) => [argument.name, words] as const);
        });
        fc.assert(
            fc.property(fc.tuple(...given), (entries) => {
                const values: Values = Object.fromEntries(entries.filter(([, words]) => words.length > 0));
                const line = lineOf(command, values, "# note");
                const call = readCall(schema, line);
                assert.equal(call?.command.name, command.name, line);
                assert.deepEqual({ ...call?.values }, { ...values }, line);
                assert.equal(call?.comment, "# note");
            }),
            { numRuns: 60 },
        );
    }
});

test("default values are omitted, and missing required values are reported", () => {
    const [name, center, radius] = called("sphere").arguments;
    let values: Values = { name: ["s"] };
    values = withValue(radius, values, ["2"]);
    values = withValue(center, values, ["0,0,1"]);
    assert.deepEqual(values, { name: ["s"], radius: ["2"], center: ["0,0,1"] });
    values = withValue(radius, values, ["1.0"]);
    values = withValue(center, values, ["0, 0,0.0"]);
    assert.deepEqual(values, { name: ["s"] });
    assert.deepEqual(missing(called("sphere"), withValue(name, values, [""])), [name]);
    const seed = called("pointset generate").arguments[5];
    assert.deepEqual(withValue(seed, {}, ["0"]), { seed: ["0"] }); // set seed may have changed the default
    const points = called("pointset generate").arguments[6];
    assert.equal(defaultWord(points, { solid: ["crown"] }), "crown");
    assert.deepEqual(withValue(points, { solid: ["crown"] }, ["crown"]), { solid: ["crown"] });
});

test("an incomplete line is not an error while it is typed", () => {
    const half = [
        "sph",
        "sphere",
        "sphere a radius=",
        "sphere a rad",
        'save t "my',
        "sphere a radius=${h",
        "translate a 1 2",
        "union a",
        "let x",
        "let x =",
        "for i in 1",
        "grow t \\",
        "pointset",
        "pointset generate",
    ];
    const whole = [
        "",
        "# x",
        "sphere a",
        "sphere a radius=2",
        "translate a 1 2 3",
        "translate a 0,0,${h}",
        "union a b",
        "let x = 2",
        "for i in 1..3",
        "end",
        "else",
        "scale a 2",
        "mesh t",
        'save t ""',
    ];
    half.forEach((line) => assert.equal(unfinished(schema, line), true, line));
    whole.forEach((line) => assert.equal(unfinished(schema, line), false, line));
});

test("a new name replaces all references to the object, and no other words", () => {
    const text = [
        "sphere crown # the crown",
        "sphere crown2 center=0,0,1",
        "union crown crown2 both",
        'let crown = "crown"',
        "for i in 1..2",
        "  scale crown ${i}",
        "end",
        "pointset generate crown poisson",
        "grow tree crown root=0,0,0",
        'edit prune tree "tips & solid(crown)"',
        "skin s p crown@0.5 other@1",
        'save "crown" crown.xyz',
        "",
    ].join("\n");
    const { text: now, lines } = renamed(schema, text, "crown", "top");
    assert.equal(
        now,
        [
            "sphere top # the crown",
            "sphere crown2 center=0,0,1",
            "union top crown2 both",
            'let crown = "top"',
            "for i in 1..2",
            "  scale top ${i}",
            "end",
            "pointset generate top poisson",
            "grow tree top root=0,0,0",
            'edit prune tree "tips & solid(top)"',
            "skin s p top@0.5 other@1",
            "save top crown.xyz",
            "",
        ].join("\n"),
    );
    assert.deepEqual([...lines], [0, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert.equal(renamed(schema, text, "bough", "x").lines.size, 0);
});

test("renaming twice restores the text", () => {
    const line = fc.constantFrom(
        "sphere a",
        "sphere b radius=2",
        "union a b c",
        "scale a 2",
        "grow a a",
        'let a = "a"',
        "# a",
        "delete a b",
        "edit prune a solid(a)",
        "repeat 2\n  translate a 0 0 1\nend",
    );
    fc.assert(
        fc.property(fc.array(line), (lines) => {
            const text = lines.map((one) => `${one}\n`).join("");
            assert.equal(renamed(schema, renamed(schema, text, "a", "quite_other").text, "quite_other", "a").text, text);
        }),
    );
});

test("the statements that created an object are found in the text", () => {
    const statements = piecesOf("sphere a\nscale a 2\nsphere a radius=3\npointset generate a\ntranslate a 0 0 1\ngrow a a\nmesh a\nsave a a.obj\n");
    assert.deepEqual(stepsOf(schema, statements, { kind: "solid", name: "a" }, 4), [2, 4]);
    assert.deepEqual(stepsOf(schema, statements, { kind: "points", name: "a" }, 3), [3]);
    const meshed = piecesOf("grow a p\nmesh a\nscale a 2 kind=skeleton\ncopy b a kind=mesh\n");
    assert.deepEqual(stepsOf(schema, meshed, { kind: "skeleton", name: "a" }, 2), [0, 2]);
    assert.deepEqual(stepsOf(schema, meshed, { kind: "mesh", name: "a" }, 3), [3]);
    assert.deepEqual(
        placesIn(schema, "repeat 2\n  translate a 0 0 1\nend").map(({ role, from }) => [role, from]),
        [["changes", 21]],
    );
});
