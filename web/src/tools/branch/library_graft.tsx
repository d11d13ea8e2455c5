// Grafts a branch of a library on a tree: at the point under the pointer, or at the selected node.
import { type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolPointer, ToolRun } from "../../app";
import type { ObjectName, State } from "../../protocol";
import { linesOf } from "../../script/pieces";
import { readLine } from "../../script/words";
import { Overlay, kColors } from "../kit/overlay";
import { Button, NumberField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { finalLine, type NodeLine, previewLine } from "../kit/naming";
import { fetchSkeleton, followSkeletons, type Skeleton, skeletonOf } from "../kit/skeleton";
import { rewriteStatement } from "../kit/source";
import { startedByKey } from "../kit/key_start";
import { commandLine, numberWord } from "../kit/words";
import { placeOnSegment } from "./bend";
import { anySkeleton } from "./cut";
import { type Host, hostUnder } from "./host";

const kCommand = "library graft";
const kRollStep = 15; // [degrees] step of a key
const kSizeStep = 1.1;

export interface LibraryBranch {
    file: string;
    number: number;
}

/** The branch chosen in the library. */
export const chosenBranch: Signal<LibraryBranch | null> = signal(null);

const roll = signal(0);
const size = signal(1);

interface Place {
    about: ObjectName;
    skeleton: Skeleton; // state before all previews
    host: Host;
}

/** The line that grafts the branch; nodes are anchored if possible. */
export function graftLine(branch: LibraryBranch, name: string, host: number, along: number, turned: number, sized: number): NodeLine {
    const options = {
        along: along < 0.995 ? numberWord(along, 0.01) : undefined,
        roll: turned !== 0 ? numberWord(turned, 0.1) : undefined,
        scale: sized !== 1 ? numberWord(sized, 1e-3) : undefined,
    };
    return { name, nodes: [[host]], line: ([on]) => commandLine([kCommand, name, branch.file, branch.number, on], options) };
}

/** The index of the last statement that adds to a library; -1 if there is no such statement. */
export function lastAddition({ statements, ran }: State, file: string): number {
    const adds = (line: string) =>
        readLine(line)
            .words.slice(0, 3)
            .map(({ text }) => text)
            .join("\n") === `library\nadd\n${file}`;
    return statements.slice(0, ran).findLastIndex(({ text }) => linesOf(text).some((line) => adds(line.text)));
}

let held: LibraryGraftRun | null = null;

/** The active tool, which receives the position of a drag from the library. */
export function libraryGraftHeld(): LibraryGraftRun | null {
    return held;
}

export class LibraryGraftRun implements ToolRun {
    private readonly overlay: Overlay;
    private readonly unfollow: () => void;
    private readonly trees = new Map<string, Skeleton>(); // before previews
    private gesture: Gesture | null = null;
    private readonly placed = signal<Place | null>(null); // where the branch is shown

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.unfollow = followSkeletons(app);
        if (startedByKey()) {
            void this.showOnSelected();
        }
    }

    stop(): void {
        this.gesture?.cancel();
        this.unfollow();
        this.overlay.stop();
        held = null;
    }

    status(): string {
        const branch = chosenBranch.value;
        if (!branch) {
            return "Choose a branch in the library first.";
        }
        const place = this.placed.value;
        const where = place ? ` on node ${place.skeleton.ids[place.host.n]} of ${place.about.name}` : "";
        return (
            this.gesture?.refusal ||
            `Grafts branch ${branch.number}${where}. Click a point of the tree, or select a node and press Enter; arrow keys roll and resize it.`
        );
    }

    panel(): VNode {
        return (
            <>
                <NumberField label="Roll" unit="°" value={roll} low={-360} high={360} changed={() => this.show()} />
                <NumberField label="Size" value={size} low={0.01} high={100} changed={() => this.show()} />
                <Button label="Graft on the selected node" run={() => void this.placeOnSelected()} />
            </>
        );
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "cancel") {
            this.leave();
            return false;
        }
        if (event.phase === "move" && event.buttons === 0) {
            this.over(event.x, event.y);
            return false;
        }
        if (event.phase === "down" && event.buttons === 1 && this.over(event.x, event.y)) {
            void this.end();
            return true;
        }
        return false;
    }

    key(event: KeyboardEvent): boolean {
        switch (event.key) {
            case "Enter":
                void (this.placed.peek() ? this.end() : this.placeOnSelected());
                return true;
            case "ArrowLeft":
            case "ArrowRight":
                roll.value = (roll.peek() + (event.key === "ArrowLeft" ? -kRollStep : kRollStep)) % 360;
                break;
            case "ArrowUp":
            case "ArrowDown":
                size.value = Number((size.peek() * (event.key === "ArrowUp" ? kSizeStep : 1 / kSizeStep)).toPrecision(3));
                break;
            default:
                return false;
        }
        this.show();
        return true;
    }

    /** Shows the branch at a position of the view; returns false if there is no tree. */
    over(x: number, y: number): boolean {
        const found = this.placeUnder(x, y);
        if (found) {
            this.placed.value = found;
            this.show();
        } else {
            this.leave();
        }
        return found !== null;
    }

    /** Keeps the shown branch. */
    async end(): Promise<void> {
        const nodeLine = this.nodeLine();
        const { gesture } = this;
        const place = this.placed.peek();
        if (nodeLine && gesture && place) {
            this.gesture = null;
            this.placed.value = null;
            this.overlay.clear();
            await this.keep(gesture, await finalLine(this.app, nodeLine), place.about);
            this.trees.clear();
        }
    }

    // A line about a tree is usually inserted before the statements that use it: here it has to follow the statement that filled
    // the library.
    private async keep(gesture: Gesture, line: string, { kind, name }: ObjectName): Promise<void> {
        const state = this.app.store.state.peek();
        const filled = lastAddition(state, chosenBranch.peek()?.file ?? "");
        if (filled <= (this.app.store.find(kind, name)?.statement ?? filled)) {
            await gesture.run(line);
            return;
        }
        try {
            await rewriteStatement(this.app, filled, `${state.statements[filled].text.replace(/\n$/, "")}\n${line}`, line, false);
        } catch (error) {
            gesture.cancel();
            this.app.store.notify((error as Error).message, "error");
        }
    }

    async placeOnSelected(): Promise<void> {
        if (await this.showOnSelected()) {
            await this.end();
        } else {
            this.app.store.notify("Select a node of a tree first: the branch is grafted there.", "warning");
        }
    }

    /** Shows the branch at the selected node; returns false if no node is selected. */
    async showOnSelected(): Promise<boolean> {
        const { object, nodes } = this.app.store.selection.peek();
        const skeleton = object?.kind === "skeleton" ? await fetchSkeleton(this.app, object.name) : null;
        const n = skeleton && nodes.length > 0 ? skeleton.index(nodes[0]) : -1;
        if (!object || !skeleton || n < 0) {
            return false;
        }
        this.trees.set(object.name, skeleton);
        this.placed.value = { about: object, skeleton, host: { n, along: 1 } };
        this.show();
        return true;
    }

    // During a preview the view shows a tree that is not in the document; parents are nodes of the tree in the document.
    private before(name: string): Skeleton | null {
        const known = this.trees.get(name) ?? (this.gesture ? null : skeletonOf(this.app, name));
        if (known) {
            this.trees.set(name, known);
        }
        return known;
    }

    private placeUnder(x: number, y: number): Place | null {
        const pick = this.app.view.pick(x, y, ["skeleton"]);
        const about = pick?.object ?? this.placed.peek()?.about;
        const skeleton = about && this.before(about.name);
        if (!about || !skeleton) {
            return null;
        }
        if (pick?.node !== undefined && skeleton.index(pick.node) < 0) {
            return this.placed.peek(); // the previewed branch itself
        }
        const host = hostUnder(this.app, about.name, skeleton, x, y);
        return host && { about: { kind: "skeleton", name: about.name }, skeleton, host };
    }

    private nodeLine(): NodeLine | null {
        const branch = chosenBranch.peek();
        const place = this.placed.peek();
        if (!branch || !place) {
            return null;
        }
        const { about, skeleton, host } = place;
        return graftLine(branch, about.name, skeleton.ids[host.n], host.along, roll.peek(), size.peek());
    }

    private show(): void {
        const nodeLine = this.nodeLine();
        const place = this.placed.peek();
        this.overlay.clear();
        if (nodeLine && place) {
            const { about, skeleton, host } = place;
            if (this.gesture?.about?.name !== about.name) {
                this.gesture?.cancel();
                this.gesture = new Gesture(this.app, about);
            }
            this.gesture.preview(previewLine(nodeLine));
            this.overlay.dots([placeOnSegment(skeleton, host.n, host.along)], kColors.grow, 11);
        }
    }

    /** The pointer has left the tree. */
    leave(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.placed.value = null;
        this.overlay.clear();
    }
}

export const libraryGraftTools: Tool[] = [
    {
        id: "library-graft",
        label: "From library",
        group: "compose",
        help: "Grafts the branch chosen in the library on a tree: drag it there, click, or select a node and press Enter.",
        enabled: (app) => anySkeleton(app) && app.store.schema.peek().some(({ name }) => name === kCommand),
        start: (app) => {
            held = new LibraryGraftRun(app);
            return held;
        },
    },
];
