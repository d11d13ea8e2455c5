// The library that is open in the page, and trees composed from it.
import { effect, type Signal, signal, untracked } from "@preact/signals-core";
import type { App, Geometry } from "../../app";
import type { SceneObject, State } from "../../protocol";
import { lineOf, type Values } from "../../script/values";
import { runLine } from "../../tools/kit/gesture";
import { anchored } from "../../tools/kit/naming";
import { type Skeleton, selectedTops } from "../../tools/kit/skeleton";
import { commandLine } from "../../tools/kit/words";
import { chosenBranch } from "../../tools/branch/library_graft";
import { listFiles } from "../files/folder";
import { Card, creatorOf } from "../grow/card";
import { objectOf } from "../grow/model";
import { type Branch, type Filter, filterValues, kAll, type Order } from "./filter";

export const kEnding = ".branches";
const kTrial = "trial"; // name of preview trees

/** The first node after the fork where the branch of a node begins. */
export function branchStart(skeleton: Skeleton, n: number): number {
    for (let parent = skeleton.parent(n); parent >= 0 && skeleton.children[parent].length === 1; parent = skeleton.parent(n)) {
        n = parent;
    }
    return n;
}

export class LibraryModel {
    readonly files: Signal<string[]> = signal([]);
    readonly file = signal(""); // empty: not chosen yet
    readonly branches: Signal<Branch[]> = signal([]);
    readonly filter: Signal<Filter> = signal(kAll);
    readonly order: Signal<Order> = signal<Order>("length");
    readonly errorText = signal("");
    readonly onlyShown = signal(false); // trees are composed from the filtered branches only
    readonly firstSeed = signal(1);
    readonly card: Card;
    private additions = ""; // the statements that add to the library, as last read
    private selected = "";

    constructor(readonly app: App) {
        this.card = new Card(app, {
            commands: ["compose"],
            suggest: (_, __, given) => this.suggest(given),
            shows: true,
            ran: (target) => {
                const template = this.template();
                if (target) {
                    app.store.selection.value = { ...app.store.selection.peek(), object: target, nodes: [] };
                }
                if (target && template) {
                    app.store.hideFor([template], target); // both are at the same position
                }
            },
        });
        effect(() => this.follow());
    }

    async look(): Promise<void> {
        try {
            this.files.value = (await listFiles(this.app, kEnding)).map(({ name }) => name);
            if (this.file.peek() === "" && this.files.peek().length > 0) {
                await this.open(this.files.peek()[0]);
            }
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
        }
    }

    /** Opens a library, including one that is created when a branch is added. */
    async open(file: string): Promise<void> {
        this.file.value = file;
        chosenBranch.value = null;
        await this.read();
    }

    async read(): Promise<void> {
        const file = this.file.peek();
        if (!this.files.peek().includes(file)) {
            this.branches.value = [];
            return;
        }
        try {
            const { branches } = await this.app.engine.request<{ branches: Branch[] }>("library", { file });
            this.errorText.value = "";
            if (file === this.file.peek()) {
                this.branches.value = branches;
            }
        } catch (error) {
            this.branches.value = [];
            this.errorText.value = (error as Error).message;
        }
    }

    async skeleton(number: number): Promise<Geometry> {
        const { key } = await this.app.engine.request<{ key: string }>("branch", { file: this.file.peek(), number });
        return this.app.engine.blob(key);
    }

    /** Stores all branches of a tree, or the selected ones. */
    async add(tag: string, source: "tree" | "selected"): Promise<void> {
        const tops = source === "selected" ? selectedTops(this.app) : null;
        const tree = tops?.name ?? objectOf(this.app, "skeleton")?.name;
        if (!tree || (source === "selected" && !tops)) {
            this.app.store.notify("Select a tree, or branches of one, first.", "warning");
            return;
        }
        const first = tops ? new Set(tops.ids.map((id) => tops.skeleton.ids[branchStart(tops.skeleton, tops.skeleton.index(id))])) : [];
        const nodes = tops ? await anchored(this.app, tree, [...first]) : undefined;
        await runLine(this.app, commandLine(["library add", this.file.peek(), tree], { tag: tag || undefined, nodes }));
    }

    /** A tree of a seed that is not stored. */
    async trial(line: string): Promise<Geometry> {
        const { key } = await this.app.engine.request<{ key: string }>("trial", { line, kind: "skeleton", name: kTrial });
        return this.app.engine.blob(key);
    }

    /** The line of a preview tree; empty if an argument is missing. */
    trialLine(seed: number): string {
        const command = this.card.schema;
        const values = this.card.values.value;
        return command && values.template ? lineOf(command, { ...values, name: [kTrial], seed: [String(seed)] }) : "";
    }

    /** The tree of a seed becomes a line of the scene, or replaces the one that is being changed. */
    keep(seed: number): void {
        this.card.take("seed", String(seed));
        void this.card.run();
    }

    template(): SceneObject | undefined {
        return this.app.store.find("skeleton", this.card.values.peek().template?.[0] ?? "");
    }

    private suggest(given: Values): Values {
        const tree = objectOf(this.app, "skeleton", given.template?.[0]);
        const composed = tree && creatorOf(this.app.store.state.value, this.app.store.schema.value, tree, ["compose"]);
        const template = composed?.values.template?.[0] ?? tree?.name; // by default, a composed tree is not a template itself
        const file = this.branches.value.length > 0 ? this.file.value : "";
        return {
            name: [this.app.store.freeName("composed")],
            ...(template ? { template: [template] } : {}),
            ...(file ? { library: [file] } : {}),
            ...(file && this.onlyShown.value ? filterValues(this.filter.value) : {}),
        };
    }

    private follow(): void {
        const state = this.app.store.state.value;
        const schema = this.app.store.schema.value;
        const { object } = this.app.store.selection.value;
        void [this.branches.value, this.onlyShown.value, this.filter.value];
        if (schema.length === 0 || state.running !== null) {
            return;
        }
        untracked(() => {
            const found = object && this.app.store.find(object.kind, object.name);
            const key = found ? `${found.kind}:${found.name}` : "";
            const creator = found && key !== this.selected ? creatorOf(state, schema, found, ["compose"]) : null;
            const isOther = found?.kind === "skeleton" && key !== this.selected;
            if (this.card.busy.peek()) {
                return;
            }
            if (creator) {
                this.card.bind(creator);
            } else if (isOther && this.card.bound.peek()) {
                this.card.renew(); // another template
            } else {
                this.card.follow(state);
            }
            this.selected = key;
            this.followAdditions(state);
        });
    }

    // Libraries grow by lines of the scene, including those of other clients.
    private followAdditions(state: State): void {
        const file = this.file.peek();
        const lines = state.statements.slice(0, state.ran).filter(({ text }) => file !== "" && text.startsWith("library add") && text.includes(file));
        const additions = lines.map(({ text }) => text).join("\n");
        if (additions !== this.additions) {
            this.additions = additions;
            void this.look().then(() => this.read());
        }
    }
}

const models = new WeakMap<App, LibraryModel>();

export function libraryModel(app: App): LibraryModel {
    const known = models.get(app) ?? new LibraryModel(app);
    models.set(app, known);
    return known;
}
