// Syntax colours of the scene language.
import { type Extension, RangeSetBuilder } from "@codemirror/state";
import { Decoration, type DecorationSet, type EditorView, ViewPlugin, type ViewUpdate } from "@codemirror/view";
import type { Command } from "../../../protocol";
import { type TokenKind, tokensOf } from "./tokens";

const kKinds: readonly TokenKind[] = ["command", "language", "key", "name", "number", "string", "choice", "expression", "comment", "unknown"];
const kColors = new Map(kKinds.map((kind) => [kind, Decoration.mark({ class: `scene-${kind}` })]));

function colored(view: EditorView, schema: readonly Command[]): DecorationSet {
    const builder = new RangeSetBuilder<Decoration>();
    const { doc } = view.state;
    for (const { from, to } of view.visibleRanges) {
        for (let at = from; at <= to;) {
            const line = doc.lineAt(at);
            const continues = line.number > 1 && doc.line(line.number - 1).text.endsWith("\\");
            for (const token of tokensOf(schema, line.text, continues)) {
                const color = kColors.get(token.kind);
                if (color) {
                    builder.add(line.from + token.from, line.from + token.to, color);
                }
            }
            at = line.to + 1;
        }
    }
    return builder.finish();
}

/** Colours the visible range; `schema` may be loaded later. */
export function colors(schema: () => readonly Command[]): Extension {
    return ViewPlugin.fromClass(
        class {
            decorations: DecorationSet;
            private known: readonly Command[];

            constructor(view: EditorView) {
                this.known = schema();
                this.decorations = colored(view, this.known);
            }

            update(update: ViewUpdate): void {
                if (update.docChanged || update.viewportChanged || this.known !== schema()) {
                    this.known = schema();
                    this.decorations = colored(update.view, this.known);
                }
            }
        },
        { decorations: ({ decorations }) => decorations },
    );
}
