import assert from "node:assert/strict";
import { test } from "node:test";
import { consumeAddress } from "../src/address";

/** A tab opened at an address, with its session storage. */
function tab() {
    const values = new Map<string, string>();
    const kept = { getItem: (key: string) => values.get(key) ?? null, setItem: (key: string, value: string) => void values.set(key, value) };
    return (hash: string) => {
        const location = { hash, pathname: "/", search: "" };
        const history = {
            replaceState: (_: unknown, __: string, address: string) => {
                location.hash = address.slice(1);
            },
        };
        const parameters = consumeAddress(location as Location, history as unknown as History, kept as Storage);
        return { ...parameters, left: location.hash };
    };
}

test("the token is removed from the address and stored for reloads", () => {
    const load = tab();
    assert.deepEqual(load("#token=Ab-_9"), { token: "Ab-_9", firstFile: "", left: "" });
    assert.deepEqual(load(""), { token: "Ab-_9", firstFile: "", left: "" });
    assert.equal(load("#0123456789abcdef").token, "0123456789abcdef", "a token alone");
    assert.equal(load("#top").token, "0123456789abcdef");
    assert.equal(tab()("").token, "");
});

test("the initial file is reported once", () => {
    const load = tab();
    assert.deepEqual(load("#token=Ab9&import=some.ply"), { token: "Ab9", firstFile: "some.ply", left: "" });
    assert.deepEqual(load(""), { token: "Ab9", firstFile: "", left: "" });
    assert.deepEqual(load("#import=other.swc"), { token: "Ab9", firstFile: "other.swc", left: "" }, "also without a token");
});

test("names of files with any characters are decoded", () => {
    const named = (name: string) => tab()(`#token=a&import=${encodeURIComponent(name)}`).firstFile;
    for (const name of ["a b&c=d#e.ply", "Bäume/Höhe 50%.laz", "token=x.swc"]) {
        assert.equal(named(name), name);
    }
    assert.equal(tab()("#token=a&import=%FF.ply").firstFile, "%FF.ply", "of bytes that are not text: no such file exists, and the page reports it");
    assert.equal(tab()("#token=a&important=b").firstFile, "");
});
