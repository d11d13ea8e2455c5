// New, open and save: the scene as a file of the folder.
import type { VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { App } from "../../app";
import { openDialog, Dialog, ErrorText, useWork } from "./dialog";
import { bytesText, type FolderFile, listFiles, nameError, withEnding, writing } from "./folder";

const kEnding = ".coppice";

export async function newScene(app: App): Promise<void> {
    const isLost = app.store.state.peek().statements.length > 0;
    await app.engine.request("open", { file: "" });
    if (isLost) {
        app.store.notify("This is a new scene. Undo restores the previous one.");
    }
}

export async function openFile(app: App, file: string): Promise<void> {
    await app.engine.request("open", { file });
    app.view.frame();
}

export async function openScene(app: App): Promise<void> {
    await openDialog<null>((end) => <OpenDialog app={app} end={() => end(null)} />);
}

function OpenDialog({ app, end }: { app: App; end(): void }): VNode {
    const [files, setFiles] = useState<readonly FolderFile[] | null>(null);
    const [search, setSearch] = useState("");
    const [chosen, setChosen] = useState("");
    const { busy, errorText, work } = useWork();
    useEffect(() => void work(async () => setFiles(await listFiles(app, kEnding))), []);
    const found = (files ?? []).filter(({ name }) => name.toLowerCase().includes(search.trim().toLowerCase()));
    const file = found.some(({ name }) => name === chosen) ? chosen : (found[0]?.name ?? "");
    const open = () =>
        void work(async () => {
            await openFile(app, file);
            end();
        });
    return (
        <Dialog
            title="Open a scene"
            close={end}
            accept={file === "" || busy ? undefined : open}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={file === "" || busy}>
                        Open
                    </button>
                    <button type="button" onClick={end}>
                        Cancel
                    </button>
                </>
            }
        >
            <label class="file-field">
                <span>Search</span>
                <input type="search" value={search} autofocus onInput={(event) => setSearch(event.currentTarget.value)} />
            </label>
            <select
                class="file-list"
                size={8}
                aria-label="Scenes of the folder"
                value={file}
                onChange={(event) => setChosen(event.currentTarget.value)}
                onDblClick={open}
            >
                {found.map(({ name, bytes }) => (
                    <option key={name} value={name}>{`${name} (${bytesText(bytes)})`}</option>
                ))}
            </select>
            {files !== null && found.length === 0 && (
                <p class="hint">{files.length === 0 ? "The folder has no scene (.coppice) yet." : "No scene has this name."}</p>
            )}
            <ErrorText text={errorText} />
        </Dialog>
    );
}

/** Saves under the current name of the scene; requests a name if it has none. */
export async function saveScene(app: App): Promise<void> {
    const { file } = app.store.state.peek();
    if (file === "") {
        return saveSceneAs(app);
    }
    await app.engine.request("save", { file });
    app.store.notify(`Saved ${file}.`);
}

export async function saveSceneAs(app: App): Promise<void> {
    await openDialog<null>((end) => <SaveDialog app={app} end={() => end(null)} />);
}

function SaveDialog({ app, end }: { app: App; end(): void }): VNode {
    const [typed, setTyped] = useState(app.store.state.peek().file || "tree.coppice");
    const { busy, errorText, work } = useWork();
    const file = withEnding(typed.trim(), kEnding);
    const wrong = nameError(file);
    const save = () =>
        void work(async () => {
            if (await writing(app, file, (overwrite) => app.engine.request("save", { file, overwrite }))) {
                app.store.notify(`Saved ${file}.`);
                end();
            }
        });
    return (
        <Dialog
            title="Save the scene"
            close={end}
            accept={wrong || busy ? undefined : save}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={wrong !== "" || busy}>
                        Save
                    </button>
                    <button type="button" onClick={end}>
                        Cancel
                    </button>
                </>
            }
        >
            <label class="file-field">
                <span>Name in the folder</span>
                <input
                    type="text"
                    value={typed}
                    autofocus
                    spellcheck={false}
                    aria-invalid={wrong !== ""}
                    onFocus={(event) => event.currentTarget.select()}
                    onInput={(event) => setTyped(event.currentTarget.value)}
                />
            </label>
            <ErrorText text={wrong || errorText} />
        </Dialog>
    );
}
