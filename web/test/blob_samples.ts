// Geometry as bytes, for tests.
import type { GeometryHeader } from "../src/protocol";

type Arrays = Record<string, { data: Float32Array | Uint32Array | Uint8Array | Int8Array; size: number }>;

const kNames = new Map<unknown, "f32" | "u32" | "u8" | "i8">([
    [Float32Array, "f32"],
    [Uint32Array, "u32"],
    [Uint8Array, "u8"],
    [Int8Array, "i8"],
]);

/** The bytes of a blob; the array list of the header is created here. */
export function blobOf(header: Omit<GeometryHeader, "arrays">, arrays: Arrays): ArrayBuffer {
    let offset = 0;
    const described = Object.entries(arrays).map(([name, { data, size }]) => {
        const one = { name, type: kNames.get(data.constructor), size, count: data.length / size, offset };
        offset += Math.ceil(data.byteLength / 4) * 4;
        return one;
    });
    const text = JSON.stringify({ ...header, arrays: described });
    const head = new TextEncoder().encode(text + " ".repeat((4 - (new TextEncoder().encode(text).length % 4)) % 4));
    const buffer = new ArrayBuffer(8 + head.length + offset);
    new Uint8Array(buffer).set(new TextEncoder().encode("CPB1"));
    new DataView(buffer).setUint32(4, head.length, true);
    new Uint8Array(buffer).set(head, 8);
    described.forEach(({ name, offset: at }) => {
        const { data } = arrays[name];
        new Uint8Array(buffer).set(new Uint8Array(data.buffer, data.byteOffset, data.byteLength), 8 + head.length + at);
    });
    return buffer;
}
