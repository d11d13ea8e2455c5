// Key bindings of the editor. Few, to keep the page small; Tab leaves the editor.
import {
    cursorCharLeft,
    cursorCharRight,
    cursorDocEnd,
    cursorDocStart,
    cursorGroupLeft,
    cursorGroupRight,
    cursorLineBoundaryBackward,
    cursorLineBoundaryForward,
    cursorLineDown,
    cursorLineUp,
    cursorPageDown,
    cursorPageUp,
    deleteCharBackward,
    deleteCharForward,
    deleteGroupBackward,
    deleteGroupForward,
    deleteLine,
    moveLineDown,
    moveLineUp,
    selectAll,
    selectCharLeft,
    selectCharRight,
    selectDocEnd,
    selectDocStart,
    selectGroupLeft,
    selectGroupRight,
    selectLineBoundaryBackward,
    selectLineBoundaryForward,
    selectLineDown,
    selectLineUp,
    selectPageDown,
    selectPageUp,
} from "@codemirror/commands";
import type { ChangeSpec, Text } from "@codemirror/state";
import type { EditorView, KeyBinding } from "@codemirror/view";

const kIndent = 2; // additional indent inside a block

function indentOf(text: string): number {
    return /^ */.exec(text)?.[0].length ?? 0;
}

/** The indent of the line that opened the block which a line ends, searched upwards. */
function openerIndent(doc: Text, line: number): number {
    let depth = 1;
    for (let n = line - 1; n >= 1; --n) {
        const { text } = doc.line(n);
        depth += /^\s*end\b/.test(text) ? 1 : /^\s*(?:for|repeat|if)\b/.test(text) ? -1 : 0;
        if (depth === 0) {
            return indentOf(text);
        }
    }
    return 0;
}

/** A new line with the indent of its block; an `end` is aligned with its opener. */
export function newLine({ state, dispatch }: EditorView): boolean {
    if (state.readOnly) {
        return false;
    }
    const { from, to } = state.selection.main;
    const line = state.doc.lineAt(from);
    const before = line.text.slice(0, from - line.from);
    const closes = /^\s*(?:end|else)$/.test(before);
    const own = closes ? openerIndent(state.doc, line.number) : indentOf(before);
    const indent = own + (/^\s*(?:for|repeat|if|else)\b/.test(before) ? kIndent : 0);
    const blanks = indentOf(line.text);
    const changes: ChangeSpec[] = [{ from, to, insert: `\n${" ".repeat(indent)}` }];
    if (closes && blanks !== own) {
        changes.unshift({ from: line.from, to: line.from + blanks, insert: " ".repeat(own) });
    }
    const shift = closes ? own - blanks : 0;
    dispatch(state.update({ changes, selection: { anchor: from + shift + 1 + indent }, scrollIntoView: true, userEvent: "input" }));
    return true;
}

/** Comments or uncomments the selected lines. */
export function toggleComments({ state, dispatch }: EditorView): boolean {
    const { from, to } = state.selection.main;
    const lines = [];
    for (let n = state.doc.lineAt(from).number; n <= state.doc.lineAt(to).number; ++n) {
        lines.push(state.doc.line(n));
    }
    const written = lines.filter(({ text }) => text.trim() !== "");
    const all = written.length > 0 && written.every(({ text }) => /^\s*#/.test(text));
    const changes = written.map((line): ChangeSpec => {
        const at = line.from + indentOf(line.text);
        const mark = /^# ?/.exec(line.text.slice(at - line.from))?.[0].length ?? 0;
        return all ? { from: at, to: at + mark } : { from: at, insert: "# " };
    });
    dispatch(state.update({ changes, userEvent: "input" }));
    return !state.readOnly;
}

export const kEditorKeys: readonly KeyBinding[] = [
    { key: "ArrowLeft", run: cursorCharLeft, shift: selectCharLeft },
    { key: "ArrowRight", run: cursorCharRight, shift: selectCharRight },
    { key: "Mod-ArrowLeft", mac: "Alt-ArrowLeft", run: cursorGroupLeft, shift: selectGroupLeft },
    { key: "Mod-ArrowRight", mac: "Alt-ArrowRight", run: cursorGroupRight, shift: selectGroupRight },
    { key: "ArrowUp", run: cursorLineUp, shift: selectLineUp },
    { key: "ArrowDown", run: cursorLineDown, shift: selectLineDown },
    { key: "PageUp", run: cursorPageUp, shift: selectPageUp },
    { key: "PageDown", run: cursorPageDown, shift: selectPageDown },
    { key: "Home", mac: "Cmd-ArrowLeft", run: cursorLineBoundaryBackward, shift: selectLineBoundaryBackward },
    { key: "End", mac: "Cmd-ArrowRight", run: cursorLineBoundaryForward, shift: selectLineBoundaryForward },
    { key: "Mod-Home", mac: "Cmd-ArrowUp", run: cursorDocStart, shift: selectDocStart },
    { key: "Mod-End", mac: "Cmd-ArrowDown", run: cursorDocEnd, shift: selectDocEnd },
    { key: "Backspace", run: deleteCharBackward, shift: deleteCharBackward },
    { key: "Delete", run: deleteCharForward },
    { key: "Mod-Backspace", mac: "Alt-Backspace", run: deleteGroupBackward },
    { key: "Mod-Delete", mac: "Alt-Delete", run: deleteGroupForward },
    { key: "Mod-a", run: selectAll },
    { key: "Alt-ArrowUp", run: moveLineUp },
    { key: "Alt-ArrowDown", run: moveLineDown },
    { key: "Mod-Shift-k", run: deleteLine },
    { key: "Mod-/", run: toggleComments },
    { key: "Enter", run: newLine },
];
