// Import of external files: dropped on the page or chosen. They are copied into the folder, and loaded according to their
// content.
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { App } from "../../app";
import type { Kind } from "../../protocol";
import { joined, readLine } from "../../script/words";
import { readSketch } from "../../sketch/model";
import { layOutSketch } from "../../sketch/tool";
import { runLine } from "../../tools/kit/gesture";
import { commandLine, newName } from "../../tools/kit/words";
import { useValue } from "../../use";
import { selectWhenCreated } from "./select_created";
import { openDialog, choose, Dialog } from "./dialog";
import { bytesText, freeFile, listFiles, objectName } from "./folder";
import { type Content, contentOf, kReadEndings, NotRead } from "./kinds";
import { openFile } from "./scenes";

/** The use of a file: a command of scenes, or an action of the page. */
type Use = "loadtree" | "loadmesh" | "pointset load" | "extract" | "open" | "sketch" | "keep";

const kUses: Record<Content, readonly Use[]> = {
    skeleton: ["loadtree"],
    mesh: ["loadmesh", "extract"],
    points: ["pointset load", "extract"],
    scene: ["keep"], // or opened, if the user chooses that
    sketch: ["sketch"],
    library: ["keep"],
    photograph: ["keep"],
};

const kUseLabels: Partial<Record<Use, string>> = {
    loadmesh: "Load the mesh",
    "pointset load": "Load the points",
    extract: "Extract the skeleton of the tree",
};

const kMakes: Partial<Record<Use, Kind>> = { loadtree: "skeleton", loadmesh: "mesh", "pointset load": "points", extract: "skeleton" };

const kKept: Partial<Record<Content, string>> = {
    library: "The library panel shows its branches.",
    photograph: "The tool Sketch can draw over it.",
};

interface ImportedFile {
    file: File;
    content: Content;
    use: Use;
    isThere: boolean; // already in the folder
}

/** Current action, for the status line of imports; empty if idle. */
const kImportStatus = signal("");

/** Imports a file of the folder, unless the scene uses it already. */
export async function importNamed(app: App, name: string): Promise<void> {
    if (!isUsed(app, name)) {
        await importFiles(app, [new File([await app.engine.file(name)], name)], true);
    }
}

/** Imports files in sequence; reports for each refused file the reason. */
export async function importFiles(app: App, files: readonly File[], areThere = false): Promise<void> {
    try {
        const imports = await chooseUses(app, await readContents(app, files, areThere));
        for (const one of imports) {
            await importOne(app, one);
        }
    } catch (error) {
        app.store.notify((error as Error).message, "error");
    } finally {
        kImportStatus.value = "";
    }
}

async function readContents(app: App, files: readonly File[], isThere: boolean): Promise<ImportedFile[]> {
    const imports: ImportedFile[] = [];
    for (const file of files) {
        try {
            const content = await contentOf(file.name, file);
            imports.push({ file, content, use: kUses[content][0], isThere });
        } catch (error) {
            const why = error instanceof NotRead ? error.message : "cannot be read; it may be a folder, or no longer exist";
            app.store.notify(`${file.name} ${why}.`, "error");
        }
    }
    return imports;
}

/** Asks the user about files with several uses. A scene is opened last, and uses the files imported with it. */
async function chooseUses(app: App, imports: readonly ImportedFile[]): Promise<readonly ImportedFile[]> {
    const scenes = imports.filter(({ content }) => content === "scene");
    const scene = scenes.length === 1 ? await chooseSceneUse(app, scenes[0]) : null;
    if (scenes.length === 1 && !scene) {
        return [];
    }
    const others = imports.filter(({ content }) => content !== "scene");
    if (scene?.use === "open") {
        return [...others.map((one): ImportedFile => ({ ...one, use: "keep" })), scene];
    }
    const open = others.filter(({ content }) => kUses[content].length > 1);
    const answers = open.length > 0 ? await requestUses(open) : [];
    return answers === null ? [] : [...(scene ? [scene] : scenes), ...others.map((one) => answers[open.indexOf(one)] ?? one)];
}

async function chooseSceneUse(app: App, scene: ImportedFile): Promise<ImportedFile | null> {
    if (app.store.state.peek().statements.length === 0) {
        return { ...scene, use: "open" };
    }
    const text = "It replaces the open scene; undo restores that one.";
    const use = await choose<Use>(`Open ${scene.file.name}?`, text, [
        ["open", "Open it"],
        ["keep", "Only copy it into the folder"],
    ]);
    return use && { ...scene, use };
}

function requestUses(imports: readonly ImportedFile[]): Promise<readonly ImportedFile[] | null> {
    return openDialog((end) => <UsesDialog imports={imports} end={end} />);
}

function UsesDialog({ imports, end }: { imports: readonly ImportedFile[]; end(answer: readonly ImportedFile[] | null): void }): VNode {
    const [uses, setUses] = useState(imports.map(({ use }) => use));
    return (
        <Dialog
            title={imports.length === 1 ? `How should ${imports[0].file.name} be imported?` : "How should these files be imported?"}
            close={() => end(null)}
            accept={() => end(imports.map((one, at) => ({ ...one, use: uses[at] })))}
            buttons={
                <>
                    <button type="submit" class="primary">
                        Import
                    </button>
                    <button type="button" onClick={() => end(null)}>
                        Cancel
                    </button>
                </>
            }
        >
            {imports.map(({ file, content }, at) => (
                <fieldset class="file-uses" key={file.name}>
                    <legend>{`${file.name}: ${content === "points" ? "points" : `a ${content}`}, ${bytesText(file.size)}`}</legend>
                    {kUses[content].map((use, n) => (
                        <label key={use} class="file-check">
                            <input
                                type="radio"
                                name={`use-${at}`}
                                checked={uses[at] === use}
                                autofocus={at === 0 && n === 0}
                                onChange={() => setUses(uses.map((old, k) => (k === at ? use : old)))}
                            />
                            <span>{kUseLabels[use]}</span>
                        </label>
                    ))}
                </fieldset>
            ))}
        </Dialog>
    );
}

async function importOne(app: App, { file, content, use, isThere }: ImportedFile): Promise<void> {
    const placed = isThere ? { name: file.name, replaced: false } : await place(app, file);
    if (!placed) {
        return;
    }
    const { name, replaced } = placed;
    if (replaced && (await app.engine.request<{ found: boolean }>("rerun", { file: name })).found) {
        app.store.notify(`${name} was replaced, and the statements that use it were run again.`);
        return;
    }
    const makes = kMakes[use];
    if (makes) {
        kImportStatus.value = use === "extract" ? `Extracting the skeleton of ${name}…` : `Reading ${name}…`;
        await make(app, use, makes, name);
    } else if (use === "open") {
        await openFile(app, name);
    } else if (use === "sketch") {
        layOutSketch(app, readSketch(await file.text()));
    } else {
        app.store.notify(`${name} is in the folder. ${kKept[content] ?? ""}`.trim());
    }
}

/** Copies a file into the folder. Null if the user neither replaces the existing one nor chooses another name. */
async function place(app: App, file: File): Promise<{ name: string; replaced: boolean } | null> {
    const there = await listFiles(app);
    const same = there.find(({ name }) => name === file.name);
    if (same && same.bytes === file.size && (await isAlike(await app.engine.file(file.name), file))) {
        return { name: file.name, replaced: false };
    }
    const answer = same ? await confirmReplacement(app, file.name) : "new";
    if (answer === null) {
        return null;
    }
    const name = answer === "both" ? freeFile(file.name, new Set(there.map((one) => one.name))) : file.name;
    kImportStatus.value = `Copying ${name} into the folder: ${bytesText(file.size)}…`;
    await app.engine.upload(name, file, answer === "replace");
    return { name, replaced: answer === "replace" };
}

function isUsed(app: App, name: string): boolean {
    const names = (line: string) => readLine(line).words.some(({ text }) => text === name);
    return app.store.state.peek().statements.some(({ text }) => joined(text).split("\n").some(names));
}

function confirmReplacement(app: App, name: string): Promise<"replace" | "both" | null> {
    const used = isUsed(app, name);
    const then = used ? " The scene uses it, and the statements that use it run again." : "";
    const answers = [
        ["replace", "Replace"],
        ["both", "Keep both"],
    ] as const;
    const text = `The folder already contains another file ${name}.${then}`;
    return choose("Replace the file?", text, used ? answers : answers.toReversed());
}

async function isAlike(a: Blob, b: Blob): Promise<boolean> {
    const [left, right] = [new Uint8Array(await a.arrayBuffer()), new Uint8Array(await b.arrayBuffer())];
    return left.length === right.length && left.every((byte, at) => byte === right[at]);
}

async function make(app: App, use: Use, kind: Kind, file: string): Promise<void> {
    const ran = await runLine(app, commandLine([...use.split(" "), newName(objectName(file)), file]));
    const created = ran && (await selectWhenCreated(app, (object) => object.kind === kind && object.name === ran.names[0]));
    if (created) {
        app.view.frame([created]);
    }
}

/** Lets the user choose files. */
export function chooseFiles(app: App): void {
    const input = document.createElement("input");
    input.type = "file";
    input.multiple = true;
    input.accept = kReadEndings.join(",");
    input.onchange = () => void importFiles(app, [...(input.files ?? [])]);
    input.click();
}

/** The files of a drop. Folders are reported by name: their files have to be dropped directly. */
function filesOf(app: App, data: DataTransfer): File[] {
    const files: File[] = [];
    for (const item of data.items) {
        const file = item.kind === "file" ? item.getAsFile() : null;
        if (item.webkitGetAsEntry?.()?.isDirectory) {
            app.store.notify(`${file?.name ?? "This"} is a folder; drop the files in it, or open it by: coppice studio FOLDER`, "error");
        } else if (file) {
            files.push(file);
        }
    }
    return files;
}

/** Accepts files dropped on the page, and shows the progress of the import. */
export function DropZone({ app }: { app: App }): VNode {
    const [over, setOver] = useState(false);
    const status = useValue(kImportStatus);
    useEffect(() => {
        const holdsFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
        const drag = (event: DragEvent) => {
            if (holdsFiles(event)) {
                event.preventDefault();
                setOver(document.querySelector("dialog[open]") === null);
            }
        };
        const leave = (event: DragEvent) => {
            if (event.relatedTarget === null) {
                setOver(false);
            }
        };
        const drop = (event: DragEvent) => {
            if (holdsFiles(event) && event.dataTransfer) {
                event.preventDefault(); // otherwise the browser would navigate to the file
                setOver(false);
                if (!document.querySelector("dialog[open]")) {
                    void importFiles(app, filesOf(app, event.dataTransfer));
                }
            }
        };
        addEventListener("dragover", drag);
        addEventListener("dragleave", leave);
        addEventListener("drop", drop);
        return () => {
            removeEventListener("dragover", drag);
            removeEventListener("dragleave", leave);
            removeEventListener("drop", drop);
        };
    }, []);
    return (
        <>
            {over && (
                <div class="drop-zone" aria-hidden="true">
                    <p>Drop trees, meshes, points, scenes or images</p>
                </div>
            )}
            <p class="import-status" role="status" hidden={status === ""}>
                {status}
            </p>
        </>
    );
}
