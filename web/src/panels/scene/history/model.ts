// The changes of the document, in the order of time.
import type { State } from "../../../protocol";

export interface Change {
    name: string;
    when: "done" | "now" | "undone";
    steps: number; // to undo (below 0) or redo to be there
}

const kMostNames = 100; // that STATE tells

/** The changes from the oldest known on; the one that led to what the document is now has no steps. */
export function changesOf({ undo, redo }: Pick<State, "undo" | "redo">): Change[] {
    const start: Change[] = undo.length < kMostNames ? [{ name: "The beginning", when: undo.length === 0 ? "now" : "done", steps: -undo.length }] : [];
    const done = undo.map((name, i): Change => ({ name, when: i === undo.length - 1 ? "now" : "done", steps: i + 1 - undo.length }));
    const undone = [...redo].reverse().map((name, i): Change => ({ name, when: "undone", steps: i + 1 }));
    return [...start, ...done, ...undone].map((change) => ({ ...change, steps: change.steps === 0 ? 0 : change.steps }));
}
