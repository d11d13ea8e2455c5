// A component of the page next to the 3D view, which makes room for it.
import type { ComponentChildren } from "preact";
import { render } from "preact";
import type { App } from "../../app";

export class SidePane {
    readonly element = document.createElement("div");

    constructor(app: App, className: string) {
        this.element.className = `side-pane ${className}`;
        app.view.element().closest(".picture-frame")?.append(this.element);
    }

    render(children: ComponentChildren): void {
        render(children, this.element);
    }

    stop(): void {
        render(null, this.element);
        this.element.remove();
    }
}
