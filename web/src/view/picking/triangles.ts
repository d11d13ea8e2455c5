// Indices for drawing quads: two triangles for each, and lines along the edges.

export function triangulateQuads(quads: Uint32Array): Uint32Array<ArrayBuffer> {
    const index = new Uint32Array((quads.length / 4) * 6);
    fillTriangles(quads, index, 0);
    return index;
}

/** Writes the triangles of `quads` into `index`, starting at the position of quad `first`. */
export function fillTriangles(quads: Uint32Array, index: Uint32Array, first: number): void {
    let at = first * 6;
    for (let i = 0; i < quads.length; i += 4) {
        index[at++] = quads[i];
        index[at++] = quads[i + 1];
        index[at++] = quads[i + 2];
        index[at++] = quads[i];
        index[at++] = quads[i + 2];
        index[at++] = quads[i + 3];
    }
}

/**
 * End points of the lines along the edges of faces with `corners` corners. A closed surface has each edge once in each direction,
 * so that the one from the smaller to the larger index represents both; for an open surface some border edges are missing.
 */
export function edgeLines(faces: Uint32Array, corners: 3 | 4): Uint32Array<ArrayBuffer> {
    const lines = new Uint32Array(faces.length * 2);
    let at = 0;
    for (let i = 0; i < faces.length; i += corners) {
        for (let k = 0; k < corners; ++k) {
            const a = faces[i + k];
            const b = faces[i + ((k + 1) % corners)];
            if (a < b) {
                lines[at++] = a;
                lines[at++] = b;
            }
        }
    }
    return lines.slice(0, at);
}
