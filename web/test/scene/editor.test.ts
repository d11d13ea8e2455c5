// The text of the scene and the document: conflicts, marks, colours, help and completion.
import assert from "node:assert/strict";
import { test } from "node:test";
import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import fc from "fast-check";
import type { App } from "../../src/app";
import { completionAt, commandCompletions, completions, wordCompletion } from "../../src/panels/scene/editor/complete";
import { helpAt } from "../../src/panels/scene/editor/help";
import { newLine, toggleComments } from "../../src/panels/scene/editor/keys";
import { marksOf } from "../../src/panels/scene/editor/marks";
import { changesBetween, normal, Sync } from "../../src/panels/scene/editor/sync";
import { tokensOf } from "../../src/panels/scene/editor/tokens";
import { difference, merged } from "../../src/script/merge";
import { createStore, placed } from "../../src/store";
import { schema, stateOf } from "./schema";

function begun(text: string): Sync {
    const sync = new Sync();
    sync.receive(text, "");
    return sync;
}

test("changes by other clients are merged into the typed text", () => {
    const sync = begun("sphere a\nsphere b\n");
    assert.equal(sync.receive("sphere a\nscale a 2\nsphere b\n", "sphere a\nsphere b\n"), "sphere a\nscale a 2\nsphere b\n");
    const mine = "sphere a\nscale a 2\nsphere b radius=3";
    assert.equal(sync.isTyped(mine), true);
    const both = sync.receive("sphere a radius=5\nscale a 2\nsphere b\nunion a b c\n", mine);
    assert.equal(both, "sphere a radius=5\nscale a 2\nsphere b radius=3\nunion a b c\n");
    assert.equal(sync.theirs, null);
    assert.equal(sync.isTyped(both), true);
    assert.equal(sync.receive(both, both), both);
    assert.equal(sync.isTyped(both), false);
});

test("lines that are typed and added by a gesture at the end do not conflict", () => {
    const sync = begun("sphere a\n");
    assert.equal(sync.receive("sphere a\nscale a 2\n", "sphere a\nsphere b"), "sphere a\nscale a 2\nsphere b\n");
});

test("a line changed on both sides keeps the typed text until one side is chosen", () => {
    const mine = "sphere a radius=2\nsphere b\nsphere d\n";
    const theirs = "sphere a radius=3\nsphere b\nsphere c\n";
    const sync = begun("sphere a\nsphere b\nsphere c\n");
    assert.equal(sync.receive(theirs, mine), mine);
    assert.equal(sync.theirs, theirs);
    assert.equal(sync.settle(mine, "mine"), "sphere a radius=2\nsphere b\nsphere d\n");
    assert.equal(sync.theirs, null);
    assert.equal(sync.isTyped(mine), true);

    const other = begun("sphere a\nsphere b\nsphere c\n");
    other.receive(theirs, mine);
    assert.equal(other.settle(mine, "theirs"), "sphere a radius=3\nsphere b\nsphere d\n");
    assert.equal(other.base, theirs);

    const undone = begun("sphere a\n");
    undone.receive("sphere a radius=3\n", "sphere a radius=2\n");
    assert.notEqual(undone.theirs, null);
    assert.equal(undone.receive("sphere a\n", "sphere a radius=2\n"), "sphere a radius=2\n");
    assert.equal(undone.theirs, null);
});

test("text typed while an earlier text is applied is inserted once", () => {
    const sync = begun("sphere a\n");
    sync.sent = "sphere a\ngrow t a\n";
    assert.equal(sync.receive("sphere a\ngrow t a\n", "sphere a\ngrow t a step=2"), "sphere a\ngrow t a step=2");
    assert.equal(sync.base, "sphere a\ngrow t a\n");
    assert.equal(sync.isTyped("sphere a\ngrow t a step=2"), true);
});

test("different line ends are not a change", () => {
    const sync = begun("sphere a\r\nsphere b\r\n");
    assert.equal(sync.isTyped("sphere a\nsphere b"), false);
    assert.equal(normal(""), "");
    assert.equal(normal("a"), "a\n");
});

const text = fc.array(fc.constantFrom("a", "b", "c", "d", ""), { maxLength: 8 }).map((lines) => lines.join("\n"));

test("the difference of two texts is found and can be applied", () => {
    fc.assert(
        fc.property(text, text, (a, b) => {
            const lines = a.split("\n");
            const out: string[] = [];
            let at = 0;
            for (const hunk of difference(lines, b.split("\n"))) {
                out.push(...lines.slice(at, hunk.from), ...hunk.lines);
                at = hunk.to;
            }
            assert.equal([...out, ...lines.slice(at)].join("\n"), b);
            const state = EditorState.create({ doc: a });
            assert.equal(state.update({ changes: changesBetween(a, b) }).state.doc.toString(), b);
        }),
    );
});

test("cursors in unchanged lines keep their positions", () => {
    const before = "sphere a\nscale a 2 center=\nsphere b"; // no line end after the last line
    const after = "sphere a radius=2\nscale a 2 center=\nsphere b\n";
    const at = before.indexOf("=") + 1;
    const state = EditorState.create({ doc: before, selection: { anchor: at } }).update({ changes: changesBetween(before, after) }).state;
    assert.equal(state.doc.toString(), after);
    assert.equal(state.doc.lineAt(state.selection.main.head).text, "scale a 2 center=");
    assert.equal(state.selection.main.head, at + " radius=2".length);
});

test("an empty line and a removed line are different changes", () => {
    assert.equal(merged("d\na", "d\n", "d"), null);
    assert.equal(merged("d\na", "d\n", "d", "mine"), "d\n");
});

test("two concurrent changes are both kept", () => {
    fc.assert(
        fc.property(text, text, text, (base, mine, theirs) => {
            assert.equal(merged(base, base, theirs), theirs);
            assert.equal(merged(base, mine, base), mine);
            assert.equal(merged(base, mine, mine, "mine"), mine);
            assert.notEqual(merged(base, mine, theirs, "mine"), null);
            const both = merged(base, mine, theirs);
            if (both !== null) {
                const old = base.split("\n");
                const added = [...difference(old, mine.split("\n")), ...difference(old, theirs.split("\n"))].flatMap((hunk) => hunk.lines);
                const lines = both.split("\n");
                added.forEach((line) => assert.ok(lines.includes(line)));
            }
        }),
    );
});

test("statements are marked with their status", () => {
    const state = {
        ...stateOf("sphere a\nscale a 2\nsphere b\nunion a b c\n", [
            ["solid:a", 1],
            ["solid:b", 2],
        ]),
        ran: 3,
    };
    const failed = { ...state, error: { statement: 3, line: 4, message: "there is no solid 'b'" } };
    const marks = marksOf(failed, schema, null, { kind: "solid", name: "a" });
    assert.deepEqual(
        marks.map(({ status }) => status),
        ["ran", "ran", "ran", "failed"],
    );
    assert.deepEqual(
        marks.map(({ chosen }) => chosen),
        ["step", "creator", "", ""],
    );
    assert.deepEqual([marks[3].message, marks[3].wrong], ["there is no solid 'b'", 4]);
    const running = marksOf({ ...state, running: 3 }, schema, { statement: 3, fraction: 0.5 }, null);
    assert.deepEqual([running[3].status, running[3].fraction], ["runs", 0.5]);
    assert.equal(marksOf({ ...state, ran: 2 }, schema, null, null)[3].status, "waits");
});

test("errors in blocks are shown at their own line", () => {
    const state = stateOf("sphere a\nrepeat 2\n  scale b 2\nend\n");
    const failed = { ...state, ran: 1, error: { statement: 1, line: 2, message: "my scene.coppice:3: there is no solid 'b'" } };
    assert.deepEqual(placed(failed).error, { statement: 1, line: 3, message: "there is no solid 'b'" });
    assert.equal(marksOf(placed(failed), schema, null, null)[1].wrong, 3);
    const other = { ...failed, error: { statement: 1, line: 2, message: "a block is not closed" } };
    assert.equal(placed(other), other);
});

function coloured(line: string, continues = false): string {
    return tokensOf(schema, line, continues)
        .map(({ from, to, kind }) => `${kind}(${line.slice(from, to)})`)
        .join(" ");
}

test("words of a line are coloured by their kind", () => {
    assert.equal(coloured("sphere a radius=2 law=soft # x"), "command(sphere) name(a) key(radius=) number(2) key(law=) choice(soft) comment(# x)");
    assert.equal(coloured("pointset generate a count=${2 * n}"), "command(pointset) command(generate) name(a) key(count=) expression(${2 * n})");
    assert.equal(coloured("translate a 0,0,${h}"), "command(translate) name(a) expression(${h})");
    assert.equal(coloured("for i in 1..3 step 2"), "language(for) language(in) number(1.) number(3) language(step) number(2)");
    assert.equal(coloured('let a = "x"'), 'language(let) string("x")');
    assert.equal(coloured("sphere a colour=2"), "command(sphere) name(a) unknown(colour=2)");
    assert.equal(coloured("  radius=2", true), "number(2)");
    assert.equal(coloured("spere a"), "");
});

test("tokens are ordered, disjoint and inside the line", () => {
    fc.assert(
        fc.property(fc.constantFrom("sphere ", "let ", "grow t ", ""), fc.string(), (begin, rest) => {
            const line = begin + rest.replace(/[\r\n]/g, " ");
            let at = 0;
            for (const { from, to } of tokensOf(schema, line)) {
                assert.ok(from >= at && to > from && to <= line.length, line);
                at = to;
            }
        }),
    );
});

test("help describes the word at the cursor", () => {
    assert.equal(helpAt(schema, "sphere a radius=2", 3)?.title, "sphere NAME [OPTION=VALUE...]");
    const radius = helpAt(schema, "sphere a radius=2", 12);
    assert.deepEqual([radius?.title, radius?.from, radius?.to], ["radius=", 9, 17]);
    assert.equal(radius?.text, "Meaning of radius. Accepts a number [m] from 0.00001 to 100000. Default: 1.");
    assert.equal(helpAt(schema, "mesh t", 99), null);
    assert.equal(helpAt(schema, "mesh t u", 8)?.text, "Name of the new mesh. Accepts a new name. Default: that of tree.");
    assert.equal(helpAt(schema, "repeat 3", 2)?.title, "repeat COUNT");
    assert.equal(helpAt(schema, "# sphere", 4), null);
    assert.equal(helpAt(schema, "spere a", 2), null);
});

test("completion replaces the word before the cursor", () => {
    assert.deepEqual(completionAt("sph"), { from: 0, text: "sph", type: "command" });
    assert.deepEqual(completionAt("  "), { from: 2, text: "", type: "command" });
    assert.deepEqual(completionAt("sphere a rad"), { from: 9, text: "rad", type: "word" });
    assert.deepEqual(completionAt("sphere a law=s"), { from: 9, text: "law=s", type: "word" });
    assert.deepEqual(completionAt("sphere a "), { from: 9, text: "", type: "word" });
    assert.deepEqual(completionAt("sphere a radius=${2 * he"), { from: 22, text: "he", type: "expression" });
    assert.equal(completionAt("sphere a # rad"), null);
    assert.equal(completionAt('save a "my'), null);
    assert.equal(
        commandCompletions(schema).some(({ label }) => label === "pointset generate"),
        true,
    );
    const radius = wordCompletion(schema, "sphere a ", "radius=", []);
    assert.deepEqual([radius.type, radius.detail], ["property", "m"]);
    const crown = wordCompletion(schema, "scale ", "crown", stateOf("sphere crown", [["solid:crown", 0]]).objects);
    assert.deepEqual([crown.type, crown.detail], ["variable", "solid"]);
});

function completing(doc: string, reply: string[]): { app: App; target: Record<string, unknown>[]; context: CompletionContext } {
    const store = createStore();
    store.schema.value = schema;
    const target: Record<string, unknown>[] = [];
    const request = (_: string, fields: Record<string, unknown>) => {
        target.push(fields);
        return Promise.resolve({ words: reply });
    };
    const state = EditorState.create({ doc });
    return { app: { store, engine: { request } } as unknown as App, target, context: new CompletionContext(state, doc.length, false) };
}

test("names are requested from the engine for the state before the line", async () => {
    const { app, target, context } = completing("sphere a\nsphere b\n  union a b", ["b", "bough"]);
    const result = await completions(app, (line) => line - 1)(context);
    assert.deepEqual(target, [{ line: "union a b", count: 2 }]);
    assert.deepEqual(
        result?.options.map(({ label }) => label),
        ["bough"],
    ); // existing text is not offered
    assert.equal(result?.from, "sphere a\nsphere b\n  union a ".length);
});

test("commands and variables are completed without the engine", async () => {
    const commands = completing("let height = 3\nsph", []);
    const result = await completions(commands.app, () => 0)(commands.context);
    assert.equal(
        result?.options.some(({ label }) => label === "sphere"),
        true,
    );
    assert.deepEqual(commands.target, []);
    const variables = completing("let height = 3\nsphere a radius=${he", []);
    const names = await completions(variables.app, () => 0)(variables.context);
    assert.equal(names?.options[0].label, "height");
    const blank = completing("sphere a ", ["radius="]);
    assert.equal(await completions(blank.app, () => 0)(blank.context), null); // Enter has to insert a new line
});

function edited(doc: string, command: (view: EditorView) => boolean, at = doc.length): string {
    let state = EditorState.create({ doc, selection: { anchor: at } });
    command({
        state,
        dispatch: (transaction: { state: EditorState }) => {
            state = transaction.state;
        },
    } as unknown as EditorView);
    return `${state.doc.sliceString(0, state.selection.main.head)}|${state.doc.sliceString(state.selection.main.head)}`;
}

test("a new line has the indentation of its block", () => {
    assert.equal(edited("for i in 1..2", newLine), "for i in 1..2\n  |");
    assert.equal(edited("for i in 1..2\n  sphere a", newLine), "for i in 1..2\n  sphere a\n  |");
    assert.equal(edited("for i in 1..2\n  if i\n    sphere a\n    end", newLine), "for i in 1..2\n  if i\n    sphere a\n  end\n  |");
    assert.equal(edited("if i\n  sphere a\n  else", newLine), "if i\n  sphere a\nelse\n  |");
    assert.equal(edited("sphere a", newLine, 6), "sphere\n| a");
});

test("lines are commented out and restored", () => {
    assert.equal(edited("  sphere a", toggleComments, 4), "  # sp|here a");
    assert.equal(edited("  # sphere a", toggleComments, 6), "  sp|here a");
    assert.equal(edited("#sphere", toggleComments, 7), "sphere|");
});
