// Triangulates quads; large numbers are processed in a worker.
import { triangulateQuads } from "./triangles";

const kMany = 50000; // quads, about 4 ms

let worker: Worker | null = null;
let last = 0;
const waiting = new Map<number, (index: Uint32Array) => void>();

function start(): Worker {
    const worker = new Worker("/worker.js", { type: "module" });
    worker.onmessage = (event: MessageEvent<{ id: number; index: Uint32Array }>) => {
        waiting.get(event.data.id)?.(event.data.index);
        waiting.delete(event.data.id);
    };
    return worker;
}

/** Calls `then` with the triangles, at once for a small number of quads. */
export function withTriangles(quads: Uint32Array | undefined, then: (index?: Uint32Array) => void): void {
    if (!quads || quads.length < 4 * kMany) {
        then(quads && triangulateQuads(quads));
        return;
    }
    worker ??= start();
    const id = ++last;
    const copy = quads.slice();
    waiting.set(id, then);
    worker.postMessage({ id, quads: copy }, [copy.buffer]);
}
