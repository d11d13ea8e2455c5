import assert from "node:assert/strict";
import { test } from "node:test";
import fc from "fast-check";
import { BlobError, parseGeometry } from "../src/blob";
import { blobOf } from "./blob_samples";

const kHeader = { kind: "surface" as const, object: { kind: "mesh" as const, name: "Eiche größe" }, version: 3, origin: [1, 2, 3] as [number, number, number] };

test("arrays of a blob are views of its bytes", () => {
    const buffer = blobOf(kHeader, {
        position: { data: new Float32Array([0, 1, 2, 3, 4, 5]), size: 3 },
        normal: { data: new Int8Array([0, 0, 127, 0, 0, -127, 0, 0]), size: 4 },
        quads: { data: new Uint32Array([0, 1, 1, 0]), size: 4 },
    });
    const { header, arrays } = parseGeometry(buffer);
    assert.equal(header.object.name, "Eiche größe");
    assert.deepEqual([...arrays.position], [0, 1, 2, 3, 4, 5]);
    assert.deepEqual([...arrays.normal], [0, 0, 127, 0, 0, -127, 0, 0]);
    assert.equal(arrays.position.buffer, buffer);
    assert.equal(arrays.quads.byteOffset - arrays.normal.byteOffset, 8);
});

test("an array outside the blob is rejected", () => {
    const buffer = blobOf(kHeader, { position: { data: new Float32Array(6), size: 3 } });
    assert.throws(() => parseGeometry(buffer.slice(0, buffer.byteLength - 4)), BlobError);
    assert.throws(() => parseGeometry(buffer.slice(0, 20)), BlobError);
    assert.throws(() => parseGeometry(new ArrayBuffer(4)), BlobError);
});

test("changed bytes result in geometry or an Error, without reads out of bounds", () => {
    const whole = new Uint8Array(blobOf(kHeader, { position: { data: new Float32Array(30), size: 3 } }));
    fc.assert(
        fc.property(fc.nat(whole.length - 1), fc.nat(255), fc.nat(whole.length), (at, byte, length) => {
            const changed = whole.slice(0, length);
            if (at < length) {
                changed[at] = byte;
            }
            try {
                const { arrays } = parseGeometry(changed.buffer);
                for (const array of Object.values(arrays)) {
                    assert.ok(array.byteOffset + array.byteLength <= length);
                }
            } catch (error) {
                assert.ok(error instanceof Error && !(error instanceof assert.AssertionError));
            }
        }),
    );
});
