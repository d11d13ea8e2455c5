// node tangents.mjs FILE.glb ...: exits with 1 if the tangents of a file differ from those of the reference implementation of
// MikkTSpace by more than 0.001, except at triangles without area on the surface or in the texture, and at vertices that differ only by
// their second set of texture coordinates, which MikkTSpace joins.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const { generateTangents } = createRequire(import.meta.url)("mikktspace");
const kMaxError = 1e-3;
const kComponents = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

// Returns a function that reads the accessor of an index, of floats or unsigned integers.
async function open(file) {
  const bytes = await readFile(file);
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length));
  const buffer = bytes.subarray(28 + length);
  const read = (index) => {
    const { bufferView, type, count, componentType } = json.accessors[index];
    const begin = json.bufferViews[bufferView].byteOffset;
    const Numbers = componentType === 5125 ? Uint32Array : Float32Array;
    return new Numbers(Uint8Array.from(buffer.subarray(begin, begin + 4 * count * kComponents[type])).buffer);
  };
  return { primitives: json.meshes[0].primitives, read };
}

// Returns the values of the corners of triangles.
function unweld(values, size, indices) {
  const out = new Float32Array(size * indices.length);
  indices.forEach((vertex, corner) => out.set(values.subarray(size * vertex, size * vertex + size), size * corner));
  return out;
}

// Returns the area of a triangle from the coordinates of its corners, of two or three dimensions.
function area(values, size, triangle) {
  const at = (corner, k) => (k < size ? values[size * (3 * triangle + corner) + k] : 0);
  const side = (corner) => [0, 1, 2].map((k) => at(corner, k) - at(0, k));
  const [a, b] = [side(1), side(2)];
  return Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]) / 2;
}

// Adds the vertices that differ from others only by the values of `last` to a set.
function addJoined(out, indices, attributes, last) {
  const groups = new Map();
  indices.forEach((vertex, corner) => {
    const text = (values, size) => values.subarray(size * corner, size * corner + size).join();
    const key = attributes.map(([values, size]) => text(values, size)).join();
    if (!groups.has(key)) groups.set(key, new Map());
    groups.get(key).set(vertex, text(last, 2));
  });
  for (const group of groups.values()) {
    if (new Set(group.values()).size > 1) for (const vertex of group.keys()) out.add(vertex);
  }
}

async function compare(file) {
  const { primitives, read } = await open(file);
  const primitive = primitives[0]; // all have the same vertices
  const indices = Uint32Array.from(primitives.flatMap(({ indices: accessor }) => [...read(accessor)]));
  const [positions, normals, texture, tangents] = [
    ["POSITION", 3],
    ["NORMAL", 3],
    ["TEXCOORD_0", 2],
    ["TANGENT", 4],
  ].map(([name, size]) => unweld(read(primitive.attributes[name]), size, indices));
  const expected = generateTangents(positions, normals, texture);
  const left = new Set();
  for (let t = 0; 3 * t < indices.length; ++t) {
    if (area(positions, 3, t) > 0 && area(texture, 2, t) > 0) continue;
    for (let k = 0; k < 3; ++k) left.add(indices[3 * t + k]);
  }
  if (primitive.attributes.TEXCOORD_1 !== undefined) {
    const second = unweld(read(primitive.attributes.TEXCOORD_1), 2, indices);
    const attributes = [
      [positions, 3],
      [normals, 3],
      [texture, 2],
    ];
    addJoined(left, indices, attributes, second);
  }
  let max = 0;
  indices.forEach((vertex, corner) => {
    if (left.has(vertex)) return;
    // v points down in glTF and up in MikkTSpace, so that the sign of the bitangent is the opposite one.
    const error = [1, 1, 1, -1].map((sign, k) => Math.abs(tangents[4 * corner + k] - sign * expected[4 * corner + k]));
    max = Math.max(max, ...error);
  });
  console.log(`${file}: maximum difference ${max.toExponential(2)}, ${left.size} vertices left out`);
  return max <= kMaxError;
}

const results = await Promise.all(process.argv.slice(2).map(compare));
process.exit(results.length > 0 && results.every(Boolean) ? 0 : 1);
