// Glow of objects and nodes that are selected or under the pointer.
import * as THREE from "three";
import type { Geometry, Store } from "../app";
import type { ObjectName } from "../protocol";
import { Highlight } from "./highlight";
import { keyOf, type ObjectView } from "./object_view";
import type { Theme } from "./theme";

export class Glow {
    readonly group = new THREE.Group();
    private readonly hover = new Highlight(0.35);
    private readonly selected = new Highlight(0.5);
    private colors = { hover: "", selected: "" };

    constructor(
        private readonly store: Store,
        private readonly axesOf: (object: ObjectName) => Geometry | undefined,
    ) {
        this.group.add(this.hover.group, this.selected.group);
    }

    setTheme({ hover, selected }: Theme): void {
        this.colors = { hover, selected };
        this.hover.setColor(hover);
        this.selected.setColor(selected);
    }

    clip(planes: THREE.Plane[]): void {
        this.hover.clip(planes);
        this.selected.clip(planes);
    }

    /** Returns whether the glow has changed. */
    update(shown: readonly ObjectView[]): boolean {
        const hover = this.store.hover.peek();
        const { object, nodes, extent } = this.store.selection.peek();
        const hovered = hover?.node === undefined ? [] : [hover.node];
        let isOther = this.hover.show(hover && hovered.length > 0 ? this.axesOf(hover.object) : undefined, hovered, extent);
        isOther = this.selected.show(object ? this.axesOf(object) : undefined, nodes, extent) || isOther;
        for (const one of shown) {
            const key = keyOf(one.object);
            const isSelected = object !== null && keyOf(object) === key && nodes.length === 0;
            const isHovered = hover !== null && keyOf(hover.object) === key && hover.node === undefined;
            isOther = one.setTint(isSelected ? this.colors.selected : isHovered ? this.colors.hover : null) || isOther;
        }
        return isOther;
    }
}
