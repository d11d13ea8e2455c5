// Extraction of skeletons from meshes and scans, of the scene or in the folder, shown with their source.
import { type Signal, signal } from "@preact/signals-core";
import type { App } from "../../app";
import type { Argument, Kind, ObjectName } from "../../protocol";
import { kindsOf } from "../../script/commands";
import type { Values } from "../../script/values";
import { runLine } from "../../tools/kit/gesture";
import { commandLine } from "../../tools/kit/words";
import { endingOf, listFiles, objectName } from "../files/folder";
import { Card, creatorOf } from "./card";

const kMeshEndings = new Set([".obj", ".off", ".stl", ".glb"]);
const kPointEndings = new Set([".xyz", ".txt", ".csv", ".asc", ".pts"]); // file extensions that scenes also load as points
const kScanEndings = new Set([".ply", ".las", ".laz", ".pcd", ".ptx"]);
const kLoads = ["loadmesh", "pointset load"];

/** Files that may contain trees for extraction. */
export function scansAmong(files: readonly string[]): string[] {
    return files.filter((name) => [kMeshEndings, kPointEndings, kScanEndings].some((set) => set.has(endingOf(name))));
}

/** The commands that may load a file to show it with its skeleton, the most probable first; empty if scenes cannot load it. */
export function loadingCommands(file: string): { command: string; kind: Kind }[] {
    const mesh = { command: "loadmesh", kind: "mesh" as const };
    const points = { command: "pointset load", kind: "points" as const };
    const ending = endingOf(file);
    return ending === ".ply" ? [mesh, points] : kMeshEndings.has(ending) ? [mesh] : kPointEndings.has(ending) ? [points] : [];
}

/** The source of a skeleton: an object of the scene, or a file. */
export interface Source {
    argument: string;
    word: string;
    label: string;
}

export class Extraction {
    readonly card: Card;
    readonly files: Signal<string[]> = signal([]);
    readonly isReference = signal(true); // a scan that is only a file is loaded to be shown with its skeleton
    readonly scan: Signal<ObjectName | null> = signal(null); // of the last result

    constructor(
        private readonly app: App,
        private readonly select: (target: ObjectName) => void,
    ) {
        this.card = new Card(app, {
            commands: ["extract"],
            suggest: (_, __, given) => this.suggest(given),
            shows: false,
            ran: (target) => void this.ran(target),
        });
    }

    /** Reads the list of files in the folder. */
    async look(): Promise<void> {
        try {
            this.files.value = scansAmong((await listFiles(this.app)).map(({ name }) => name));
            this.follow();
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
        }
    }

    follow(): void {
        this.card.follow(this.app.store.state.value);
    }

    /** Returns whether a mesh or a set of points was read from a file: probably a scan. */
    isAbout(object: ObjectName): boolean {
        return this.fileOf(object) !== null;
    }

    private fileOf(object: ObjectName): string | null {
        const { state, schema } = this.app.store;
        const found = object.kind === "mesh" || object.kind === "points" ? this.app.store.find(object.kind, object.name) : undefined;
        const creator = found && creatorOf(state.peek(), schema.peek(), found, kLoads);
        const argument = creator?.command.arguments.find(({ type }) => type === "input_file");
        return (argument && creator?.values[argument.name]?.[0]) ?? null;
    }

    /** The available sources, the selected object first. */
    get sources(): Source[] {
        const { from, file } = this.arguments;
        const selected = this.app.store.selection.value.object;
        const kinds = from ? kindsOf(from) : [];
        const objects = this.app.store.state.value.objects.filter(({ kind }) => kinds.includes(kind));
        const isFirst = (object: ObjectName) => (object.kind === selected?.kind && object.name === selected.name ? 0 : 1);
        return [
            ...objects.sort((a, b) => isFirst(a) - isFirst(b)).map(({ kind, name }) => ({ argument: from?.name ?? "", word: name, label: `${kind} ${name}` })),
            ...this.files.value.map((name) => ({ argument: file?.name ?? "", word: name, label: `file ${name}` })),
        ];
    }

    get chosen(): Source | undefined {
        const values = this.card.values.value;
        return this.sources.find(({ argument, word }) => values[argument]?.[0] === word);
    }

    /** The arguments by their role. */
    private get arguments(): { name?: Argument; from?: Argument; file?: Argument } {
        const of = (type: string) => this.card.arguments.find((argument) => argument.type === type);
        return { name: of("new_name"), from: of("object"), file: of("input_file") };
    }

    private suggest(given: Values): Values {
        const { name } = this.arguments;
        const selected = this.app.store.selection.value.object;
        const all = this.sources;
        const isScan = selected !== null && this.isAbout(selected);
        const scans = all.filter(({ label }) => label.startsWith("file ") || (isScan && label === `${selected.kind} ${selected.name}`));
        const source = all.find(({ argument, word }) => given[argument]?.[0] === word) ?? scans[0];
        return source && name ? { [name.name]: [this.app.store.freeName(`${objectName(source.word)}_tree`)], [source.argument]: [source.word] } : {};
    }

    private async ran(target: ObjectName | null): Promise<void> {
        const { from, file } = this.arguments;
        const values = this.card.values.peek();
        const object = from && values[from.name]?.[0];
        const name = file && values[file.name]?.[0];
        const known = kindsOf(from ?? ({ type: "object" } as Argument))
            .map((kind) => object && this.app.store.find(kind, object))
            .find(Boolean);
        this.scan.value = known || (name && this.isReference.peek() ? await this.load(name) : null);
        if (target) {
            this.select(target);
        }
        if (this.scan.peek()) {
            this.app.view.display.bones.value = true; // axes are visible through the scan
        }
    }

    private async load(file: string): Promise<ObjectName | null> {
        const loaded = this.app.store.state.peek().objects.find((object) => this.fileOf(object) === file);
        if (loaded) {
            return loaded;
        }
        const name = this.app.store.freeName(objectName(file));
        for (const { command, kind } of loadingCommands(file)) {
            const line = commandLine([command, name, file]);
            const loads = await this.app.engine.request("aside", { line }).then(
                () => true,
                () => false,
            );
            if (loads && (await runLine(this.app, line)) !== null) {
                return { kind, name };
            }
        }
        return null;
    }
}
