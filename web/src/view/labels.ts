// Text labels at positions of the scene, as elements over the view.
import type { Label } from "../app";
import type { Point } from "../protocol";

export class Labels {
    readonly element = document.createElement("div");
    private readonly owned = new Map<string, { label: Label; element: HTMLElement }[]>();

    constructor() {
        this.element.className = "view-labels";
        this.element.setAttribute("aria-hidden", "true"); // the same text is in a panel
    }

    /** Replaces the labels of an owner. */
    set(owner: string, labels: readonly Label[]): void {
        this.owned.get(owner)?.forEach(({ element }) => element.remove());
        this.owned.delete(owner);
        if (labels.length > 0) {
            this.owned.set(
                owner,
                labels.map((label) => {
                    const element = document.createElement("span");
                    element.textContent = label.text;
                    element.className = label.style ? `view-label ${label.style}` : "view-label";
                    this.element.append(element);
                    return { label, element };
                }),
            );
        }
    }

    place(toPixels: (point: Point) => [number, number, number]): void {
        for (const entries of this.owned.values()) {
            for (const { label, element } of entries) {
                const [x, y, depth] = toPixels(label.at);
                element.hidden = Math.abs(depth) > 1;
                element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
            }
        }
    }
}
