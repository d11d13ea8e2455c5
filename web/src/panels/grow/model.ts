// The steps from a crown to a surface, with suggestions from the objects and the selection.
import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { App } from "../../app";
import type { Command, Kind, ObjectName, SceneObject, State } from "../../protocol";
import { keyOf } from "../../view/object_view";
import { commandLine } from "../../tools/kit/words";
import { check } from "../display/checks";
import { kDefaults } from "../scene/defaults";
import { Attractors } from "./attractors";
import { Card, type CardOptions, creatorOf } from "./card";
import { Extraction } from "./extraction";
import { GrowthWatch } from "./growing";
import type { Balls, RadiusName } from "./balls";
import { growthValues, rounded, tipRadius } from "./suggest";
import type { Values } from "../../script/values";
import { numberOf } from "./values";

export type StepName = "points" | "tree" | "surface" | "scan";

const kFirstCount = 2000;
const kLook = 150; // [ms] interval between tests for the arrival of a surface
const kTipOfInternode = 1 / 20; // radius of tips divided by the length of segments, for trees by rules

/** The selected object of a kind, otherwise the newest visible one. */
export function objectOf(app: App, kind: Kind, name?: string): SceneObject | undefined {
    const { objects } = app.store.state.value;
    const selected = app.store.selection.value.object;
    const hidden = app.store.hidden.peek();
    const all = objects.filter((object) => object.kind === kind).sort((a, b) => b.statement - a.statement);
    return (
        all.find((object) => object.name === name) ??
        all.find((object) => selected?.kind === kind && object.name === selected.name) ??
        all.find((object) => !hidden.has(keyOf(object))) ??
        all[0]
    );
}

function named(object: SceneObject | undefined, argument: string): Values {
    return object ? { [argument]: [object.name] } : {};
}

function pointValues(app: App, command: string, given: Values): Values {
    const solid = objectOf(app, "solid", given.solid?.[0]);
    if (command === "pointset near") {
        const mesh = objectOf(app, "mesh", given.mesh?.[0]);
        return { ...named(mesh, "mesh"), count: [String(kFirstCount)], name: [app.store.freeName("shell")] };
    }
    if (command === "pointset generate") {
        const taken = solid && app.store.find("points", solid.name);
        return { ...named(solid, "solid"), count: [String(kFirstCount)], ...(taken ? { name: [app.store.freeName("points")] } : {}) };
    }
    const points = objectOf(app, "points", given.points?.[0]);
    const change: Values = command === "pointset thin" ? { percent: ["50"] } : { count: ["200"] };
    return { ...named(points, "points"), ...named(solid, "solid"), ...change };
}

function treeValues(app: App, command: string, given: Values): Values {
    const name = { tree: [app.store.freeName("tree")] };
    const points = objectOf(app, "points", given.points?.[0]);
    if (command === "sprout" || !points) {
        return name;
    }
    return { ...name, points: [points.name], jitter: ["0.1"], ...growthValues(points.bounds, points.count) };
}

/** Radii and smoothing: without them a tree has no visible trunk. */
export function finishing(command: Command, values: Values): string[] {
    const tree = values.tree?.[0] ?? "";
    const isSprouted = command.name === "sprout";
    const tip = isSprouted ? rounded(numberOf(command, values, "internode") * kTipOfInternode) : tipRadius(numberOf(command, values, "step"));
    const radii = commandLine(["radii", tree], { tip_radius: tip });
    return isSprouted ? [radii] : [radii, commandLine(["tidy", tree])]; // smoothing would change the angles of the rules
}

export class GrowthModel {
    readonly open: Signal<StepName | null> = signal("points");
    readonly radius: Signal<RadiusName | null> = signal(null); // the radius shown as balls
    readonly growth: GrowthWatch;
    readonly attractors: Attractors;
    readonly points: Card;
    readonly tree: Card;
    readonly surface: Card;
    readonly scan: Extraction;
    private selected = "";
    private begun = false; // objects exist already

    constructor(readonly app: App) {
        this.growth = new GrowthWatch(app);
        this.attractors = new Attractors(app);
        const card = (options: Omit<CardOptions, "ran">, step: StepName) => new Card(app, { ...options, ran: (target) => this.ran(step, target) });
        this.points = card(
            { commands: ["pointset generate", "pointset near", "pointset thin", "pointset densify"], suggest: pointValues, shows: true },
            "points",
        );
        this.tree = card(
            {
                commands: ["grow", "sprout"],
                suggest: treeValues,
                shows: true,
                also: finishing,
                perform: (text, bound, target) => this.growth.perform(text, bound, target),
                stopped: () => this.growth.stopped(),
            },
            "tree",
        );
        this.surface = card(
            { commands: ["mesh"], suggest: (_, __, given) => named(objectOf(app, "skeleton", given.tree?.[0]), "tree"), shows: false },
            "surface",
        );
        this.scan = new Extraction(app, (target) => this.select(target));
        effect(() => this.follow());
    }

    /** Shows balls as long as a field of a radius is in use; returns a function that ends it. */
    showBalls(balls: Balls): () => void {
        return effect(() => {
            const name = this.radius.value;
            const command = this.tree.schema;
            const values = this.tree.values.value;
            if (name && command?.name === "grow") {
                balls.show(this.attractors.of(values.points?.[0]), command, values, name, this.app.store.hover.value?.point ?? null);
            } else {
                balls.clear();
            }
        });
    }

    private get cards(): Card[] {
        return [this.points, this.tree, this.surface];
    }

    // Cards follow the document and the selection: the selected object is changed by the card that created it.
    private follow(): void {
        const state = this.app.store.state.value;
        const schema = this.app.store.schema.value;
        const { object } = this.app.store.selection.value;
        void kDefaults.value;
        if (schema.length === 0 || state.running !== null || this.growth.now.peek()?.phase === "running") {
            return;
        }
        untracked(() => this.followSelection(state, object));
    }

    private followSelection(state: State, object: ObjectName | null): void {
        const schema = this.app.store.schema.peek();
        const key = object ? keyOf(object) : "";
        const isNew = key !== this.selected;
        this.selected = key;
        const found = object && this.app.store.find(object.kind, object.name);
        const isFirst = !this.begun && state.objects.length > 0;
        this.begun ||= isFirst;
        for (const card of this.cards) {
            const about = isFirst && !found ? newestMade(state, schema, card) : isNew ? found : undefined;
            const creator = about ? creatorOf(state, schema, about, card.options.commands) : null;
            if (creator && !card.busy.peek()) {
                card.endPreview();
                card.bind(creator);
            } else if (isNew && found && card.bound.peek() && isAboutAnother(card, found)) {
                card.renew();
            } else {
                card.follow(state);
            }
        }
        this.scan.follow();
        if (isNew && object) {
            this.open.value = stepOf(object.kind, this.scan.isAbout(object));
        }
    }

    private ran(step: StepName, target: ObjectName | null): void {
        this.growth.end();
        this.open.value = step;
        if (target) {
            this.select(target);
        }
        const points = this.tree.values.peek().points?.[0];
        if (step === "tree" && target && points) {
            this.app.store.hideFor([{ kind: "points", name: points }], target);
        } else if (step === "surface" && target) {
            void this.checkSurface(target);
        }
    }

    // The figures of a surface are shown when it is visible.
    private async checkSurface(target: ObjectName): Promise<void> {
        const { store, view } = this.app;
        const isComing = () => store.find(target.kind, target.name) && !store.hidden.peek().has(keyOf(target)) && !view.geometry(target, "surface");
        while (isComing()) {
            await new Promise((resolve) => setTimeout(resolve, kLook));
        }
        const surface = store.find(target.kind, target.name);
        if (surface) {
            await check(this.app, surface);
        }
    }

    private select(target: ObjectName): void {
        this.selected = keyOf(target); // the card already shows it
        this.app.store.selection.value = { ...this.app.store.selection.peek(), object: target, nodes: [] };
    }
}

/** Whether the selection is a different input for a new line than the object that the card changes. */
function isAboutAnother(card: Card, object: SceneObject): boolean {
    const inputs = card.arguments.filter(({ type }) => type === "object");
    const required = inputs.filter(({ kind, required }) => required && kind === object.kind);
    return required.some(({ name }) => card.values.peek()[name]?.[0] !== object.name);
}

/** The object that a card changes when the page is opened on a scene. */
function newestMade(state: State, schema: readonly Command[], card: Card): SceneObject | undefined {
    const creator = state.objects.filter((object) => creatorOf(state, schema, object, card.options.commands));
    return creator.sort((a, b) => b.statement - a.statement)[0];
}

function stepOf(kind: Kind, isScan: boolean): StepName | null {
    if (isScan) {
        return "scan";
    }
    const steps: Partial<Record<Kind, StepName>> = { solid: "points", points: "tree", skeleton: "surface", mesh: "surface" };
    return steps[kind] ?? null;
}

const models = new WeakMap<App, GrowthModel>();

export function growthModel(app: App): GrowthModel {
    const known = models.get(app) ?? new GrowthModel(app);
    models.set(app, known);
    return known;
}
