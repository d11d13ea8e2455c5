// Reads geometry from its bytes: docs/library/studio-protocol.md, "Geometry". Arrays are views of the buffer; data is not copied.
import type { Geometry } from "./app";
import type { ArrayHeader, GeometryHeader } from "./protocol";

const kMagic = 0x31425043; // "CPB1"

const kTypes = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array, i8: Int8Array };

export class BlobError extends Error {}

function readArray(buffer: ArrayBuffer, first: number, array: ArrayHeader): Geometry["arrays"][string] {
    const type = kTypes[array.type];
    const length = array.count * array.size;
    const begin = first + array.offset;
    if (!type || !Number.isInteger(length) || length < 0 || begin < first || begin % 4 !== 0 || begin + length * type.BYTES_PER_ELEMENT > buffer.byteLength) {
        throw new BlobError(`The array "${array.name}" extends beyond its blob.`);
    }
    return new type(buffer, begin, length);
}

/** Throws BlobError if the bytes are not valid geometry. */
export function parseGeometry(buffer: ArrayBuffer): Geometry {
    const view = new DataView(buffer);
    if (buffer.byteLength < 8 || view.getUint32(0, true) !== kMagic) {
        throw new BlobError("These bytes are not geometry.");
    }
    const length = view.getUint32(4, true);
    const first = 8 + length;
    if (first > buffer.byteLength || first % 4 !== 0) {
        throw new BlobError("The header of the geometry is cut off.");
    }
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length))) as GeometryHeader;
    const arrays: Geometry["arrays"] = {};
    for (const array of header.arrays) {
        arrays[array.name] = readArray(buffer, first, array);
    }
    return { header, arrays };
}
