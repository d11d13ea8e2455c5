// Grafts a branch, or a detached tree: it is dragged to its new parent branch.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool } from "../../app";
import { BranchDragRun, type Held } from "../kit/branch_drag";
import { kColors } from "../kit/overlay";
import { Button, CheckField, NumberField } from "../kit/fields";
import type { NodeLine } from "../kit/naming";
import { commandLine, numberWord } from "../kit/words";
import { placeOnSegment } from "./bend";
import { anySkeleton, subtreeSegments } from "./cut";
import { type Host, hostUnder } from "./host";
import { libraryGraftTools } from "./library_graft";

const align = signal(false);
const hostField = signal(0);

class GraftRun extends BranchDragRun {
    private typedHost = false;

    panel(): VNode {
        return (
            <>
                <NumberField label="Node of the parent" value={hostField} low={0} step={1} changed={() => this.byField()} />
                <CheckField label="Rotate with the parent" value={align} changed={() => this.show()} />
                <Button label="Graft" run={() => this.end()} />
            </>
        );
    }

    protected nodeLine(held: Held): NodeLine | null {
        const host = this.host(held);
        if (!host || held.ids.length !== 1) {
            return null;
        }
        const { skeleton, about } = held;
        const options = {
            along: host.along < 0.995 ? numberWord(host.along, 0.01) : undefined,
            align: align.peek() || undefined,
        };
        return {
            name: about.name,
            nodes: [[skeleton.ids[held.n]], [skeleton.ids[host.n]]],
            line: ([branch, on]) => commandLine(["edit", "graft", about.name, branch, on], options),
        };
    }

    protected text(held: Held | null): string {
        if (!held) {
            return "Drag a branch by its first node to its new parent branch.";
        }
        const host = this.host(held);
        const onto = host ? ` onto node ${held.skeleton.ids[host.n]}` : "";
        const action = `Grafts the branch of node ${held.skeleton.ids[held.n]}${onto}.`;
        return `${action} Release on its parent branch, or type the number of the node and Enter.`;
    }

    protected override draw(): void {
        this.overlay.clear();
        if (!this.held) {
            return;
        }
        const { skeleton, n } = this.held;
        const segments = subtreeSegments(skeleton, n);
        if (segments.length > 0) {
            this.overlay.line(segments, kColors.grow, true);
        }
        const host = this.host(this.held);
        if (host) {
            const at = placeOnSegment(skeleton, host.n, host.along);
            this.overlay.dots([at]);
            this.overlay.line([skeleton.at(n), at]);
        }
    }

    protected override clear(): void {
        this.typedHost = false;
    }

    protected override isInProgress(): boolean {
        return super.isInProgress() || this.typedHost;
    }

    private byField(): void {
        this.typedHost = true;
        this.show();
    }

    private host(held: Held): Host | null {
        const { skeleton } = held;
        const typed = this.typed.values()?.[0] ?? (this.typedHost ? hostField.peek() : undefined);
        const inside = new Set(skeleton.subtree(held.n));
        if (typed !== undefined) {
            const n = skeleton.index(typed);
            return n >= 0 && !inside.has(n) ? { n, along: 1 } : null;
        }
        // The moved branch is also under the pointer during the preview; it cannot be its own parent.
        return this.from && this.last ? hostUnder(this.app, held.about.name, skeleton, this.last.x, this.last.y, inside) : null;
    }
}

export const graftTools: Tool[] = [
    {
        id: "graft",
        label: "Graft",
        group: "branch",
        help: "Moves a branch to another parent branch: drag it there, or type the number of the parent node.",
        enabled: anySkeleton,
        start: (app: App) => new GraftRun(app),
    },
    ...libraryGraftTools,
];
