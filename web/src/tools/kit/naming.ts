// How lines name nodes: by what is found again where ids have changed, or by ids where the engine cannot do that.
import type { App } from "../../app";
import { idSelection } from "./words";

const kMostAnchors = 64; // a selection of more nodes is named by ids; its line would be too long to read
let offered = true;

/** A selection that holds these nodes, by places and kinds where the engine offers that. */
export async function anchored(app: App, name: string, ids: readonly number[]): Promise<string> {
    if (!offered || ids.length > kMostAnchors) {
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

/** A line made twice: with ids while it is previewed, anchored when it is run. */
export interface NodeLine {
    name: string; // of the skeleton
    nodes: number[][]; // ids of each selection in the line
    line(selections: string[]): string;
}

export function previewLine(made: NodeLine): string {
    return made.line(made.nodes.map((ids) => idSelection(ids)));
}

export async function finalLine(app: App, made: NodeLine): Promise<string> {
    return made.line(await Promise.all(made.nodes.map((ids) => anchored(app, made.name, ids))));
}
