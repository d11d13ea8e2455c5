// The sketch as a tool: panes with the images on the left, the tree in the view.
import type { VNode } from "preact";
import type { App, Tool, ToolRun } from "../app";
import { SidePane } from "../tools/kit/side_pane";
import { Tracked } from "../use";
import { SketchForms } from "./forms";
import { Pane } from "./pane";
import type { Sketch } from "./model";
import "./sketch.css";
import { SketchWork } from "./work";

// Strokes are kept when another tool is selected, until the sketch is added to the scene.
let kept: Sketch | null = null;

/** Activates the tool with a given sketch. */
export function layOutSketch(app: App, sketch: Sketch): void {
    app.take("select");
    kept = sketch;
    app.take("sketch");
}

class SketchRun implements ToolRun {
    private readonly work: SketchWork;
    private readonly sidePane: SidePane;

    constructor(private readonly app: App) {
        this.work = new SketchWork(app);
        if (kept) {
            void this.work.layOut(kept);
        }
        this.sidePane = new SidePane(app, "sketch-panes");
        this.sidePane.render(<Tracked draw={() => this.panes()} />);
    }

    stop(): void {
        kept = this.work.sketch.peek();
        this.sidePane.stop();
        this.work.stop();
    }

    // Letters that are shortcuts of other tools would close the sketch.
    key(event: KeyboardEvent): boolean {
        return this.sidePane.element.contains(document.activeElement) && event.key.length === 1 && !event.ctrlKey && !event.metaKey;
    }

    status(): string {
        const errorText = this.work.errorText.value;
        return errorText || "Draw each branch in both views; a click chooses a stroke; Ctrl and the wheel change the width.";
    }

    panel(): VNode {
        return <SketchForms work={this.work} done={() => this.done()} leave={() => this.app.take("select")} />;
    }

    private done(): void {
        this.app.take("select");
        kept = null;
    }

    private panes(): VNode {
        return (
            <>
                {this.work.sketch.value.views.map((view, index) => (
                    <figure key={index} class="sketch-pane">
                        <figcaption>{view.name}</figcaption>
                        <Pane work={this.work} index={index} />
                    </figure>
                ))}
            </>
        );
    }
}

export const sketchTools: Tool[] = [
    {
        id: "sketch",
        label: "Sketch",
        group: "branch",
        help: "Draws a tree in two or more images: each branch in both; the tree is shown at once.",
        start: (app) => new SketchRun(app),
    },
];
