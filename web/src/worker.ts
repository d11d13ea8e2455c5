// Computations on geometry that would block the page.
import { triangulateQuads } from "./view/picking/triangles";

interface Job {
    id: number;
    quads: Uint32Array;
}

self.onmessage = (event: MessageEvent<Job>) => {
    const index = triangulateQuads(event.data.quads);
    self.postMessage({ id: event.data.id, index }, { transfer: [index.buffer] });
};
