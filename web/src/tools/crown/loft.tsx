// Revolutions, sweeps and skins of existing profiles and paths.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App, Tool, ToolRun } from "../../app";
import type { Kind } from "../../protocol";
import { Button, ChoiceField, NumberField, PointField, pointSignals, TextField } from "../kit/fields";
import { Gesture } from "../kit/gesture";
import { commandLine, numberWord, pointWord } from "../kit/words";

export type Method = "revolve" | "sweep" | "skin";

const kMethods: readonly (readonly [Method, string])[] = [
    ["revolve", "Revolution about an axis"],
    ["sweep", "Sweep along a path"],
    ["skin", "Skin through sections"],
];
const kBlends = ["linear", "quadratic", "cubic", "smooth"].map((blend) => [blend, blend] as const);

export interface Loft {
    method: Method;
    name: string;
    profile: string;
    path: string;
    sections: readonly (readonly [string, number])[]; // profiles and fractions of the length of the path
    origin: readonly number[];
    twist: number; // [degrees]
    end: number; // scale of the profile at the end of the path
    blend: string;
}

/** Null if something is missing. */
export function loftLine(loft: Loft): string | null {
    const { method, name, profile, path, sections, origin, twist, end, blend } = loft;
    const turned = twist !== 0 ? numberWord(twist, 0.01) : undefined;
    if (method === "revolve") {
        const at = pointWord(origin, 1e-4);
        return profile ? commandLine(["revolve", name, profile], { origin: at === "0,0,0" ? undefined : at }) : null;
    }
    if (method === "sweep") {
        if (!profile || !path) {
            return null;
        }
        const line = commandLine(["sweep", name, profile, path], { twist: turned });
        return end !== 1 ? `${line} scale=0,1 scale=1,${numberWord(end, 1e-3)}` : line;
    }
    const words = sections.map(([section, part]) => `${section}@${numberWord(part, 1e-3)}`);
    return path && words.length > 1 ? commandLine(["skin", name, path, ...words], { blend: blend === "linear" ? undefined : blend, twist: turned }) : null;
}

class LoftRun implements ToolRun {
    private readonly method: Signal<Method> = signal("revolve");
    private readonly name = signal("");
    private readonly profile = signal("");
    private readonly path = signal("");
    private readonly twist = signal(0);
    private readonly end = signal(1);
    private readonly blend = signal("linear");
    private readonly origin = pointSignals([0, 0, 0]);
    private readonly sections: Signal<readonly { profile: Signal<string>; part: Signal<number> }[]> = signal([]);
    private gesture: Gesture | null = null;
    private readonly stopEffect: () => void;

    constructor(private readonly app: App) {
        this.name.value = app.store.freeName("solid");
        const { object } = app.store.selection.peek();
        this.profile.value = object?.kind === "profile" ? object.name : (this.names("profile")[0] ?? "");
        this.path.value = object?.kind === "path" ? object.name : (this.names("path")[0] ?? "");
        this.stopEffect = effect(() => {
            const first = this.profile.value;
            this.sections.value = [0, 1].map((part) => ({ profile: signal(first), part: signal(part) }));
        });
        this.show();
    }

    stop(): void {
        this.stopEffect();
        this.gesture?.cancel();
    }

    status(): string {
        return this.gesture?.refusal || (this.line() ? "Enter creates it; Esc discards it." : "Choose a profile, and a path for sweeps and skins.");
    }

    key(event: KeyboardEvent): boolean {
        if (event.key !== "Enter") {
            return false;
        }
        void this.make();
        return true;
    }

    panel(): VNode {
        const changed = () => this.show();
        const profiles = this.choices("profile");
        const method = this.method.value;
        return (
            <>
                <ChoiceField label="Is" value={this.method} choices={kMethods} changed={changed} />
                <TextField label="Name" value={this.name} />
                {method !== "skin" && <ChoiceField label="Profile" value={this.profile} choices={profiles} changed={changed} />}
                {method !== "revolve" && <ChoiceField label="Path" value={this.path} choices={this.choices("path")} changed={changed} />}
                {method === "revolve" && <PointField label="Origin of the axis" value={this.origin} changed={changed} />}
                {method === "sweep" && <NumberField label="Size at the end" value={this.end} low={0.001} changed={changed} />}
                {method === "skin" && this.sectionFields(profiles)}
                {method === "skin" && <ChoiceField label="Between sections" value={this.blend} choices={kBlends} changed={changed} />}
                {method !== "revolve" && <NumberField label="Twist" unit="°" value={this.twist} changed={changed} />}
                <Button label="Make it" run={() => void this.make()} />
            </>
        );
    }

    private sectionFields(profiles: readonly (readonly [string, string])[]): VNode {
        return (
            <>
                {this.sections.value.map(({ profile, part }, i) => (
                    <div key={i} class="tool-section">
                        <ChoiceField label={`Section ${i + 1}`} value={profile} choices={profiles} changed={() => this.show()} />
                        <NumberField label="At" value={part} low={0} high={1} step={0.05} changed={() => this.show()} />
                    </div>
                ))}
                <div class="tool-row">
                    <Button label="Add section" run={() => this.addSection()} />
                    <Button label="Remove section" disabled={this.sections.value.length < 3} run={() => this.removeSection()} />
                </div>
            </>
        );
    }

    private addSection(): void {
        const now = this.sections.peek();
        const last = now[now.length - 1];
        const added = { profile: signal(last.profile.peek()), part: signal(last.part.peek()) };
        last.part.value = (last.part.peek() + now[now.length - 2].part.peek()) / 2;
        this.sections.value = [...now, added];
        this.show();
    }

    private removeSection(): void {
        this.sections.value = this.sections.peek().slice(0, -1);
        this.show();
    }

    private names(kind: Kind): string[] {
        return this.app.store.state
            .peek()
            .objects.filter((object) => object.kind === kind)
            .map(({ name }) => name);
    }

    private choices(kind: Kind): (readonly [string, string])[] {
        return this.names(kind).map((name) => [name, name] as const);
    }

    private line(): string | null {
        return loftLine({
            method: this.method.peek(),
            name: this.name.peek(),
            profile: this.profile.peek(),
            path: this.path.peek(),
            sections: this.sections.peek().map(({ profile, part }) => [profile.peek(), part.peek()] as const),
            origin: this.origin.map((value) => value.peek()),
            twist: this.twist.peek(),
            end: this.end.peek(),
            blend: this.blend.peek(),
        });
    }

    private show(): void {
        const line = this.line();
        if (line) {
            this.gesture ??= new Gesture(this.app);
            this.gesture.preview(line);
        }
    }

    private async make(): Promise<void> {
        const line = this.line();
        const name = this.name.peek();
        if (!line) {
            this.app.store.notify("A revolution requires a profile; sweeps and skins also require a path.", "warning");
            return;
        }
        const gesture = this.gesture ?? new Gesture(this.app);
        this.gesture = null;
        if ((await gesture.run(line)) !== null) {
            this.app.store.selection.value = { ...this.app.store.selection.peek(), object: { kind: "solid", name }, nodes: [] };
            this.app.take("select");
        }
    }
}

export const loftTools: Tool[] = [
    {
        id: "loft",
        label: "Revolve, sweep, skin",
        group: "crown",
        help: "Makes a solid from profiles: revolved about an axis, swept along a path, or as a skin through sections.",
        enabled: (app) => app.store.state.peek().objects.some(({ kind }) => kind === "profile"),
        start: (app) => new LoftRun(app),
    },
];
