// Drags a branch from the library onto a tree in the view, by mouse, pen or finger.
import type { App } from "../../app";
import { chosenBranch, type LibraryBranch, LibraryGraftRun, libraryGraftHeld } from "../../tools/branch/library_graft";

const kStill = 6; // [px] maximum movement of a click

interface Drag {
    pointer: number;
    from: [number, number];
    ghost: HTMLElement | null; // follows the pointer after the first move
}

/** Event handlers for draggable elements. */
export class BranchDrag {
    private drag: Drag | null = null;

    constructor(
        private readonly app: App,
        private readonly branch: LibraryBranch,
    ) {}

    down(event: PointerEvent): void {
        if (event.button === 0) {
            (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId); // a fast pointer leaves the element before the first move
            this.drag = { pointer: event.pointerId, from: [event.clientX, event.clientY], ghost: null };
        }
    }

    move(event: PointerEvent): void {
        const { drag } = this;
        if (drag?.pointer !== event.pointerId) {
            return;
        }
        if (!drag.ghost) {
            if (Math.hypot(event.clientX - drag.from[0], event.clientY - drag.from[1]) < kStill) {
                return;
            }
            this.begin(drag, event);
        }
        const run = libraryGraftHeld();
        if (!run) {
            this.end(); // Esc deactivated the tool
            return;
        }
        const on = this.toPicture(event, run);
        drag.ghost?.style.setProperty("translate", `${event.clientX}px ${event.clientY}px`);
        drag.ghost?.classList.toggle("landing", on);
    }

    up(event: PointerEvent): void {
        const { drag } = this;
        const run = libraryGraftHeld();
        if (drag?.ghost && run) {
            const done = this.toPicture(event, run) ? run.end() : Promise.resolve();
            void done.then(() => this.app.take("select"));
        }
        this.end();
    }

    cancel(): void {
        if (this.drag?.ghost) {
            this.app.take("select");
        }
        this.end();
    }

    private begin(drag: Drag, event: PointerEvent): void {
        const card = event.currentTarget as HTMLElement;
        chosenBranch.value = this.branch;
        this.app.take("library-graft");
        const picture = card.querySelector("svg");
        const ghost = document.createElement("div");
        ghost.className = "branch-ghost";
        if (picture) {
            ghost.append(picture.cloneNode(true));
        }
        document.body.append(ghost);
        drag.ghost = ghost;
    }

    private toPicture(event: PointerEvent, run: LibraryGraftRun): boolean {
        const { left, top, right, bottom } = this.app.view.element().getBoundingClientRect();
        const { clientX: x, clientY: y } = event;
        const isInside = x >= left && x < right && y >= top && y < bottom;
        return isInside ? run.over(x - left, y - top) : (run.leave(), false);
    }

    private end(): void {
        this.drag?.ghost?.remove();
        this.drag = null;
    }
}
