// A stroke across two solids selects them; a list at the pointer offers the operations. Skeletons are joined in the same way.
import { batch, type Signal, signal } from "@preact/signals-core";
import { render, type VNode } from "preact";
import type { App, Label, Tool, ToolPointer, ToolRun } from "../../app";
import type { Kind, ObjectName, Point } from "../../protocol";
import { Tracked } from "../../use";
import { Overlay, kColors } from "../kit/overlay";
import { Button, ChoiceField, NumberField, TextField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { commandLine, numberWord } from "../kit/words";

export type Operation = "union" | "diff" | "intersection" | "blend" | "ricci" | "join";

const kOfSolids: readonly (readonly [Operation, string])[] = [
    ["union", "Union"],
    ["diff", "Difference"],
    ["intersection", "Intersection"],
    ["blend", "Blend"],
    ["ricci", "Blend with exponent"],
];
const kOfSkeletons: readonly (readonly [Operation, string])[] = [["join", "Join"]];

export function combineLine(operation: Operation, parts: readonly string[], result: string, exponent: number): string {
    return commandLine([operation, ...parts, result], {
        exponent: operation === "ricci" ? numberWord(exponent, 0.01) : undefined,
    });
}

/** Adds an object under the stroke: of the same kind as the first, each once. */
export function gather(parts: readonly ObjectName[], next: ObjectName | undefined): readonly ObjectName[] {
    const fits = next && (parts.length === 0 || parts[0].kind === next.kind);
    return fits && !parts.some(({ name }) => name === next.name) ? [...parts, next] : parts;
}

class CombineRun implements ToolRun {
    private readonly parts: Signal<readonly ObjectName[]> = signal([]);
    private readonly name = signal("");
    private readonly exponent = signal(2);
    private readonly first = signal("");
    private readonly second = signal("");
    private gesture: Gesture | null = null;
    private shown: Operation | null = null;
    private stroke: Point[] = [];
    private readonly met: Label[] = []; // names of the operands, at the positions where the stroke met them
    private before: ReadonlySet<string> | null = null; // hidden objects before a preview hides the operands
    private readonly list = document.createElement("div");
    private readonly overlay: Overlay;

    constructor(private readonly app: App) {
        this.overlay = new Overlay(app);
        this.list.className = "tool-list";
        this.list.hidden = true;
        this.list.setAttribute("role", "group");
        this.list.setAttribute("aria-label", "Operation");
        this.list.addEventListener("keydown", (event) => this.listKey(event));
        app.view.element().parentElement?.append(this.list);
        const { object } = app.store.selection.peek();
        this.first.value = object?.kind === "solid" ? object.name : (this.names("solid")[0] ?? "");
        this.second.value = this.names("solid").find((name) => name !== this.first.peek()) ?? "";
    }

    stop(): void {
        this.reset();
        render(null, this.list);
        this.list.remove();
        this.overlay.stop();
    }

    status(): string {
        if (this.gesture?.refusal) {
            return this.gesture.refusal;
        }
        const names = this.parts.value.map(({ name }) => name);
        return names.length === 0 ? "Draw a stroke across two solids, or across two skeletons." : `Across ${names.join(", ")}.`;
    }

    pointer(event: ToolPointer): boolean {
        if (event.phase === "down" && event.buttons === 1) {
            this.reset();
            this.meet(event);
            return true;
        }
        if (event.phase === "cancel") {
            this.reset();
            return true;
        }
        if (this.stroke.length === 0 || (event.buttons === 0 && event.phase === "move")) {
            return false;
        }
        if (event.phase === "move") {
            this.meet(event);
        } else {
            this.openMenu(event);
        }
        return true;
    }

    key(event: KeyboardEvent): boolean {
        if (event.key === "Escape" && !this.list.hidden) {
            this.reset();
            return true;
        }
        return false;
    }

    /** For use without a pointer: both operands from lists. */
    panel(): VNode {
        const names = this.names("solid").map((name) => [name, name] as const);
        return (
            <>
                <ChoiceField label="First" value={this.first} choices={names} changed={() => this.fromFields()} />
                <ChoiceField label="Second" value={this.second} choices={names} changed={() => this.fromFields()} />
                {this.form("solid", () => this.fromFields())}
            </>
        );
    }

    private names(kind: Kind): string[] {
        return this.app.store.state
            .peek()
            .objects.filter((object) => object.kind === kind)
            .map(({ name }) => name);
    }

    private fromFields(): void {
        const chosen = [this.first.peek(), this.second.peek()].filter((name) => name !== "");
        this.parts.value = [...new Set(chosen)].map((name) => ({ kind: "solid", name }));
        this.suggest();
    }

    private suggest(): void {
        if (this.name.peek() === "") {
            this.name.value = this.app.store.freeName(this.parts.peek()[0]?.kind === "skeleton" ? "grove" : "crown");
        }
    }

    private form(kind: Kind, before?: () => void): VNode {
        return (
            <>
                <div class="tool-choices">
                    {(kind === "solid" ? kOfSolids : kOfSkeletons).map(([operation, label]) => (
                        <span
                            key={operation}
                            onPointerEnter={() => this.show(operation, before)}
                            onPointerLeave={() => this.unshow()}
                            onFocusCapture={() => this.show(operation, before)}
                        >
                            <Button label={label} run={() => void this.make(operation, before)} />
                        </span>
                    ))}
                </div>
                {kind === "solid" && <NumberField label="Exponent" value={this.exponent} low={1} high={100} changed={() => this.again()} />}
                <TextField label="Result" value={this.name} />
            </>
        );
    }

    private meet(event: ToolPointer): void {
        const { view } = this.app;
        const pick = view.pick(event.x, event.y, [this.parts.peek()[0]?.kind ?? "solid"]) ?? view.pick(event.x, event.y, ["skeleton"]);
        const parts = gather(this.parts.peek(), pick?.object);
        if (pick && parts !== this.parts.peek()) {
            this.parts.value = parts;
            this.met.push({ at: pick.point, text: pick.object.name, style: "strong" });
            view.setLabels("combine", this.met);
        }
        const depth = pick?.point ?? this.stroke.at(-1) ?? [0, 0, 0];
        const at = view.toPlane(event.x, event.y, depth);
        if (at) {
            this.stroke.push(at);
            this.overlay.clear();
            this.overlay.line(this.stroke, kColors.grow);
            this.overlay.dots(
                this.met.map((label) => label.at),
                kColors.grow,
            );
        }
    }

    private openMenu(event: ToolPointer): void {
        const [first] = this.parts.peek();
        if (this.parts.peek().length < 2) {
            this.app.store.notify(first ? `The stroke met only ${first.name}; draw it across two.` : "The stroke met no solid.", "warning");
            this.reset();
            return;
        }
        this.suggest();
        render(<Tracked draw={() => this.form(first.kind)} />, this.list);
        this.list.hidden = false;
        const holder = this.list.parentElement;
        const most = [(holder?.clientWidth ?? 800) - this.list.offsetWidth, (holder?.clientHeight ?? 600) - this.list.offsetHeight];
        this.list.style.left = `${Math.max(Math.min(event.x, most[0]), 0)}px`;
        this.list.style.top = `${Math.max(Math.min(event.y, most[1]), 0)}px`;
        this.list.querySelector("button")?.focus();
    }

    private listKey(event: KeyboardEvent): void {
        if (event.key === "Escape") {
            this.reset();
            this.app.view.element().focus();
            event.preventDefault();
            event.stopPropagation();
        }
        const step = event.key === "ArrowRight" || event.key === "ArrowDown" ? 1 : event.key === "ArrowLeft" || event.key === "ArrowUp" ? -1 : 0;
        if (step !== 0 && event.target instanceof HTMLButtonElement) {
            const buttons = [...this.list.querySelectorAll("button")];
            buttons[(buttons.indexOf(event.target) + step + buttons.length) % buttons.length].focus();
            event.preventDefault();
        }
    }

    private show(operation: Operation, before?: () => void): void {
        before?.();
        if (this.parts.peek().length >= 2) {
            this.shown = operation;
            this.gesture ??= new Gesture(this.app);
            this.gesture.preview(this.line(operation));
            this.hideParts();
        }
    }

    private unshow(): void {
        this.gesture?.cancel();
        this.gesture = null;
        this.shown = null;
        this.showParts();
    }

    // The operands would hide the result.
    private hideParts(): void {
        const { hidden } = this.app.store;
        this.before ??= hidden.peek();
        const gone = this.parts
            .peek()
            .filter(({ name }) => name !== this.name.peek())
            .map(({ kind, name }) => `${kind}:${name}`);
        hidden.value = new Set([...this.before, ...gone]);
    }

    private showParts(): void {
        if (this.before) {
            this.app.store.hidden.value = this.before;
            this.before = null;
        }
    }

    private again(): void {
        if (this.shown) {
            this.show(this.shown);
        }
    }

    private line(operation: Operation): string {
        const names = this.parts.peek().map(({ name }) => name);
        return combineLine(operation, names, this.name.peek(), this.exponent.peek());
    }

    private async make(operation: Operation, before?: () => void): Promise<void> {
        before?.();
        const parts = this.parts.peek();
        if (parts.length < 2) {
            this.app.store.notify("Choose two different solids first.", "warning");
            return;
        }
        const name = this.name.peek();
        const line = this.line(operation);
        const gesture = this.gesture ?? new Gesture(this.app);
        this.gesture = null;
        if ((await gesture.run(line)) !== null) {
            const { selection, hideFor } = this.app.store;
            const result = { kind: parts[0].kind, name };
            batch(() => {
                this.showParts();
                hideFor(
                    parts.filter((part) => part.name !== name),
                    result,
                ); // they are contained in it
            });
            selection.value = { ...selection.peek(), object: result, nodes: [] };
            this.first.value = parts[0].kind === "solid" ? name : this.first.peek();
        }
        this.reset();
        this.app.view.element().focus();
    }

    private reset(): void {
        this.unshow();
        this.parts.value = [];
        this.stroke = [];
        this.met.length = 0;
        this.app.view.setLabels("combine", []);
        this.name.value = "";
        this.list.hidden = true;
        this.overlay.clear();
    }
}

export const combineTools: Tool[] = [
    {
        id: "combine",
        label: "Combine",
        group: "crown",
        shortcut: "U",
        help: "Combines solids: draw a stroke across two, and a list offers union, difference, intersection and blends. Skeletons are joined.",
        enabled: (app) => ["solid", "skeleton"].some((kind) => app.store.state.peek().objects.filter((object) => object.kind === kind).length > 1),
        start: (app) => new CombineRun(app),
    },
];
