// Names of nodes in lines: by anchors that remain valid when ids change, or by ids if the engine does not support anchors.
import type { App } from "../../app";
import { idSelection } from "./words";

const kMaxAnchors = 64; // a selection of more nodes is named by ids, because its line would be too long to read
let offered = true;

/** A selection of these nodes, by positions and kinds if the engine supports that. */
export async function anchored(app: App, name: string, ids: readonly number[]): Promise<string> {
    if (!offered || ids.length > kMaxAnchors) {
        return idSelection(ids);
    }
    try {
        const { selections } = await app.engine.request<{ selections: string[] }>("anchor", { name, nodes: [...ids] });
        return selections.length === ids.length ? selections.join("|") : idSelection(ids);
    } catch {
        offered = false;
        return idSelection(ids);
    }
}

/** A line in two forms: with ids during previews, anchored when it is run. */
export interface NodeLine {
    name: string; // of the skeleton
    nodes: number[][]; // ids of each selection in the line
    line(selections: string[]): string;
}

export function previewLine(nodeLine: NodeLine): string {
    return nodeLine.line(nodeLine.nodes.map((ids) => idSelection(ids)));
}

export async function finalLine(app: App, nodeLine: NodeLine): Promise<string> {
    return nodeLine.line(await Promise.all(nodeLine.nodes.map((ids) => anchored(app, nodeLine.name, ids))));
}
