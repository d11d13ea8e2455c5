// The parts of the page between which a key moves the focus.
const kParts = [".menu-bar", ".side.left", ".picture-frame", ".tool-bar", ".bottom", ".side.right"];
const kTakesFocus = "canvas, button, input, select, textarea, summary, [tabindex], [contenteditable=true]";

function canTakeFocus(element: HTMLElement): boolean {
    return element.tabIndex >= 0 && !element.matches(":disabled, [hidden] *") && element.getClientRects().length > 0;
}

/**
 * Moves the focus to the next or previous part of the page: to the view, to the element that had the focus last, or to the first
 * one.
 */
export class Parts {
    private readonly last = new WeakMap<Element, HTMLElement>();

    constructor() {
        addEventListener("focusin", ({ target }) => {
            const part = target instanceof HTMLElement && target.closest(kParts.join());
            if (part) {
                this.last.set(part, target);
            }
        });
    }

    go(step: 1 | -1): void {
        const parts = kParts.flatMap((part) => document.querySelector(part) ?? []);
        const at = parts.findIndex((part) => part.contains(document.activeElement));
        const start = at < 0 && step < 0 ? 0 : at;
        for (let n = 1; n <= parts.length; ++n) {
            const part = parts[(start + n * step + parts.length * 2) % parts.length];
            const last = this.last.get(part);
            const first = [...part.querySelectorAll<HTMLElement>(kTakesFocus)].find(canTakeFocus);
            const next = part.querySelector("canvas") ?? (last && part.contains(last) && canTakeFocus(last) ? last : first);
            if (next) {
                next.focus();
                return;
            }
        }
    }
}
