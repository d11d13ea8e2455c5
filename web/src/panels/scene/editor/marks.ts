// The status of each statement of the document, and its display in the editor.
import { type Extension, RangeSet, RangeSetBuilder, StateEffect, StateField, type Text, type Transaction } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, gutter, GutterMarker, WidgetType } from "@codemirror/view";
import type { Command, ObjectName, State } from "../../../protocol";
import { stepsOf } from "../../../script/names";

export type Status = "ran" | "runs" | "failed" | "waits";

export interface Mark {
    line: number; // number of its first line, from 1
    lines: number;
    status: Status;
    message: string; // its output, or its error
    wrong: number; // the line of the text that failed; 0 without an error
    fraction: number; // of a running one; 0 if unknown
    chosen: "" | "creator" | "step"; // it created the selected object ("creator"), or changed it before ("step")
}

/** The marks of all statements. */
export function marksOf(
    state: State,
    schema: readonly Command[],
    progress: { statement: number | null; fraction: number } | null,
    selected: ObjectName | null,
): Mark[] {
    const creator = selected ? state.objects.find(({ kind, name }) => kind === selected.kind && name === selected.name)?.statement : undefined;
    const steps = new Set(selected && creator !== undefined ? stepsOf(schema, state.statements, selected, creator) : []);
    const ran = Math.max(state.ran, state.running ?? 0);
    return state.statements.map(({ text, line, message }, i) => {
        const failed = state.error?.statement === i;
        const status = state.running === i ? "runs" : failed ? "failed" : i < ran ? "ran" : "waits";
        return {
            line,
            lines: text.split("\n").length,
            status,
            wrong: failed ? (state.error?.line ?? 0) : 0,
            message: failed ? (state.error?.message ?? "") : message.trim(),
            fraction: progress?.statement === i ? progress.fraction : 0,
            chosen: i === creator ? "creator" : steps.has(i) ? "step" : "",
        };
    });
}

class MessageWidget extends WidgetType {
    constructor(
        readonly text: string,
        readonly failed: boolean,
    ) {
        super();
    }

    override eq(other: MessageWidget): boolean {
        return other.text === this.text && other.failed === this.failed;
    }

    toDOM(): HTMLElement {
        const element = document.createElement("span");
        element.className = this.failed ? "cm-message cm-message-error" : "cm-message";
        const [first, ...more] = this.text.split("\n");
        element.textContent = more.length > 0 ? `${first} …` : first;
        element.title = this.text;
        return element;
    }

    override ignoreEvent(): boolean {
        return false; // a click on it moves to its line
    }
}

const kTitles: Record<Status, string> = {
    ran: "This line has run; click to go back to here",
    runs: "This line is running",
    failed: "This line failed",
    waits: "This line has not run; click to run to here",
};

class Ran extends GutterMarker {
    constructor(
        readonly status: Status,
        readonly percent: number,
        readonly last: boolean,
    ) {
        super();
    }

    override eq(other: Ran): boolean {
        return other.status === this.status && other.percent === this.percent && other.last === this.last;
    }

    override toDOM(): HTMLElement {
        const element = document.createElement("div");
        element.className = `cm-ran cm-ran-${this.status}${this.last ? " cm-ran-last" : ""}`;
        element.title = kTitles[this.status];
        element.textContent = { ran: "", runs: this.percent > 0 ? `${this.percent}%` : "…", failed: "!", waits: "" }[this.status];
        return element;
    }
}

interface Shown {
    lines: DecorationSet;
    gutter: RangeSet<GutterMarker>;
}

const kWrong = Decoration.mark({ class: "cm-wrong", attributes: { "aria-invalid": "true" } });
const kSetMarks = StateEffect.define<readonly Mark[]>();

function shownOf(doc: Text, marks: readonly Mark[]): Shown {
    const lines = new RangeSetBuilder<Decoration>();
    const ran = new RangeSetBuilder<GutterMarker>();
    const lastRan = marks.findLastIndex(({ status }) => status === "ran");
    const isPartial = lastRan < marks.length - 1; // the last statement that ran is marked only if others follow
    marks.forEach((mark, number) => {
        const last = Math.min(mark.line + mark.lines - 1, doc.lines);
        for (let n = mark.line; n <= last; ++n) {
            const { from, to, text } = doc.line(n);
            const classes = [
                mark.status === "waits" ? "cm-waits" : mark.status === "runs" ? "cm-runs" : "",
                mark.chosen === "" ? "" : `cm-${mark.chosen}`,
            ].filter((name) => name !== "");
            if (classes.length > 0) {
                lines.add(from, from, Decoration.line({ class: classes.join(" ") }));
            }
            if (n === mark.wrong && to > from) {
                lines.add(from + (/^\s*/.exec(text)?.[0].length ?? 0), to, kWrong);
            }
            if (n === (mark.wrong || last) && mark.message !== "") {
                lines.add(to, to, Decoration.widget({ widget: new MessageWidget(mark.message, mark.status === "failed"), side: 1 }));
            }
            const isLast = isPartial && number === lastRan && n === last;
            ran.add(from, from, new Ran(mark.status, n === mark.line ? Math.round(mark.fraction * 100) : 0, isLast));
        }
    });
    return { lines: lines.finish(), gutter: ran.finish() };
}

// Marks move with the text; the output of a line is removed when the line is changed.
function moved(shown: Shown, { changes }: Transaction): Shown {
    const touched = (at: number) => changes.touchesRange(at) !== false;
    const lines = shown.lines.update({ filter: (from, _, { spec }) => !(spec.widget && touched(from)) });
    return { lines: lines.map(changes), gutter: shown.gutter.map(changes) };
}

const kMarks = StateField.define<Shown>({
    create: () => ({ lines: Decoration.none, gutter: RangeSet.empty }),
    update(shown, transaction) {
        const set = transaction.effects.find((effect) => effect.is(kSetMarks));
        const now = transaction.docChanged ? moved(shown, transaction) : shown;
        return set ? shownOf(transaction.state.doc, set.value as readonly Mark[]) : now;
    },
    provide: (field) => EditorView.decorations.from(field, ({ lines }) => lines),
});

export function setMarks(marks: readonly Mark[]): StateEffect<readonly Mark[]> {
    return kSetMarks.of(marks);
}

/** Line styles by status, and a gutter that runs to the clicked line. */
export function markLines(runTo: (line: number) => void): Extension {
    return [
        kMarks,
        gutter({
            class: "cm-ran-gutter",
            markers: (view) => view.state.field(kMarks).gutter,
            initialSpacer: () => new Ran("waits", 0, false),
            domEventHandlers: {
                mousedown: (view, block) => {
                    runTo(view.state.doc.lineAt(block.from).number);
                    return true;
                },
            },
        }),
    ];
}
