// The changes of the document in chronological order.
import type { State } from "../../../protocol";

export interface Change {
    name: string;
    when: "done" | "now" | "undone";
    steps: number; // number of steps to undo (negative) or redo to reach it
}

const kMaxNames = 100; // limit of the names in STATE

/** The changes from the oldest known one; the current state has no steps. */
export function changesOf({ undo, redo }: Pick<State, "undo" | "redo">): Change[] {
    const start: Change[] = undo.length < kMaxNames ? [{ name: "The beginning", when: undo.length === 0 ? "now" : "done", steps: -undo.length }] : [];
    const done = undo.map((name, i): Change => ({ name, when: i === undo.length - 1 ? "now" : "done", steps: i + 1 - undo.length }));
    const undone = [...redo].reverse().map((name, i): Change => ({ name, when: "undone", steps: i + 1 }));
    return [...start, ...done, ...undone].map((change) => ({ ...change, steps: change.steps === 0 ? 0 : change.steps }));
}
