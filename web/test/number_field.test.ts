// Numbers as typed into fields.
import assert from "node:assert/strict";
import { test } from "node:test";
import { computed, readNumber } from "../src/script/arithmetic";

test("arithmetic expressions are evaluated", () => {
    const all: [string, number][] = [
        ["2*3", 6],
        ["1.5", 1.5],
        [" 1 + 2 * 3 ", 7],
        ["(1+2)*3", 9],
        ["10/4", 2.5],
        ["-2^2", -4],
        ["2^-1", 0.5],
        ["2^3^2", 512],
        ["0.1+0.2", 0.3],
        [".5e1", 5],
        ["--2", 2],
        ["7-2-1", 4],
        ["8/2/2", 2],
        ["2*-3", -6],
        ["1e-7", 1e-7],
    ];
    for (const [text, value] of all) {
        assert.equal(computed(text), value, text);
    }
    for (const text of ["", "abc", "2*", "(1", "1)", "1 2", "2**3", "1.2.3", "x+1", "Infinity", "0x10", "(".repeat(5000)]) {
        assert.equal(computed(text), null, text);
    }
});

test("invalid numbers and values out of range are rejected with a message", () => {
    assert.deepEqual(readNumber("2*3"), { value: 6 });
    assert.deepEqual(readNumber("1,5"), { errorText: '"1,5" has a comma; write a decimal point, as in 1.5.' });
    assert.deepEqual(readNumber("1e999"), { errorText: '"1e999" is too large.' });
    assert.deepEqual(readNumber("1/0"), { errorText: '"1/0" is too large.' });
    assert.deepEqual(readNumber("0/0"), { errorText: '"0/0" is not a number.' });
    assert.deepEqual(readNumber("abc"), { errorText: '"abc" is not a number.' });
    assert.deepEqual(readNumber("x".repeat(99)), { errorText: `"${"x".repeat(24)}…" is not a number.` });
    assert.deepEqual(readNumber("3", { low: 0, high: 2 }), { errorText: 'Enter a number from 0 to 2, not "3".' });
    assert.deepEqual(readNumber("-1", { low: 0 }), { errorText: 'Enter a number of at least 0, not "-1".' });
    assert.deepEqual(readNumber("5/2", { whole: true }), { errorText: 'Enter a whole number, not "5/2".' });
    assert.deepEqual(readNumber("5/2*2", { whole: true }), { value: 5 });
});
