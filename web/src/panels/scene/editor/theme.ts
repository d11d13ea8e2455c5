// Style of the editor.
import type { Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";

const kMono = "ui-monospace, 'DejaVu Sans Mono', monospace";

/** The nonce that the server gave this page for its style elements. */
function nonce(): string {
    return document.querySelector<HTMLMetaElement>('meta[name="nonce"]')?.content ?? "";
}

export function look(): Extension {
    return [
        EditorView.cspNonce.of(nonce()),
        EditorView.theme({
            "&": { height: "100%", color: "var(--text)", backgroundColor: "var(--sunken)" },
            "&.cm-focused": { outline: "2px solid var(--focus)", outlineOffset: "-2px" },
            ".cm-scroller": { fontFamily: kMono, lineHeight: "1.55" },
            ".cm-content": { caretColor: "var(--text)", padding: "4px 0" },
            ".cm-gutters": { backgroundColor: "var(--ground)", color: "var(--faint)", borderRight: "1px solid var(--line)" },
            ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--accent) 7%, transparent)" },
            ".cm-activeLineGutter": { backgroundColor: "transparent", color: "var(--text)" },
            ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--text)", border: "1px solid var(--line)", borderRadius: "var(--radius)" },
            ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: kMono, maxHeight: "14em" },
            ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "3px 8px" },
            ".cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]": { backgroundColor: "var(--accent-ground)", color: "var(--accent-text)" },
            ".cm-completionDetail": { color: "inherit", opacity: "0.8" },
            ".cm-completionInfo": { whiteSpace: "pre-wrap", maxWidth: "28em" },
            ".cm-completionMatchedText": { textDecoration: "none", fontWeight: "bold" },
        }),
    ];
}
