// Images by the path tracer: the current view with sun, sky and shadow.
import { type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { App } from "../../app";
import type { Kind, ObjectName, SceneObject } from "../../protocol";
import { CheckField, NumberField } from "../../tools/kit/fields";
import { useValue } from "../../use";
import { keyOf } from "../../view/object_view";
import { eyeOf, sunOptions } from "./camera";
import { openDialog, Dialog, ErrorText, useWork } from "./dialog";
import { download, freeFile, listFiles, nameError, withEnding, writing } from "./folder";
import { ObjectChecks } from "./object_checks";
import { RequestProgress } from "./progress";

interface Settings {
    width: Signal<number>;
    height: Signal<number>;
    samples: Signal<number>;
    asSeen: Signal<boolean>;
    ground: Signal<boolean>;
    transparent: Signal<boolean>;
    wireframe: Signal<boolean>;
}

/** The last choice, kept while the page is open; the height is set from the view when a dialog opens. */
const kSettings: Settings = {
    width: signal(1024),
    height: signal(768),
    samples: signal(32),
    asSeen: signal(true),
    ground: signal(true),
    transparent: signal(false),
    wireframe: signal(false),
};

const kDrawn: readonly Kind[] = ["skeleton", "mesh", "solid", "points"];

export async function makePicture(app: App): Promise<void> {
    const canvas = app.view.element();
    const { width, height } = kSettings;
    height.value = Math.max(Math.round((width.peek() * canvas.clientHeight) / Math.max(canvas.clientWidth, 1)), 16);
    await openDialog<null>((end) => <PictureDialog app={app} end={() => end(null)} />);
}

/** The initial objects of an image: visible trees and meshes, otherwise all visible objects. */
function visibleObjects(objects: readonly SceneObject[], hidden: ReadonlySet<string>): ObjectName[] {
    const shown = objects.filter((object) => !hidden.has(keyOf(object)));
    const trees = shown.filter(({ kind }) => kind === "skeleton" || kind === "mesh");
    return (trees.length > 0 ? trees : shown).map(({ kind, name }) => ({ kind, name }));
}

function PictureDialog({ app, end }: { app: App; end(): void }): VNode {
    const all = app.store.state.peek().objects.filter(({ kind }) => kDrawn.includes(kind));
    const [objects, setObjects] = useState<readonly ObjectName[]>(() => visibleObjects(all, app.store.hidden.peek()));
    const [proposed, setProposed] = useState("picture.png");
    const [typed, setTyped] = useState<string | null>(null);
    const [result, setResult] = useState<{ file: string; url: string } | null>(null);
    const { busy, errorText, work } = useWork();
    const file = withEnding((typed ?? proposed).trim(), ".png");
    const wrong = objects.length === 0 ? "Choose the objects of the image." : nameError(file);
    // A free name is proposed when the folder has been read; text typed before that is kept.
    const proposeName = () =>
        void listFiles(app, ".png")
            .then((files) => setProposed(freeFile("picture.png", new Set(files.map(({ name }) => name)))))
            .catch(() => undefined);
    useEffect(proposeName, []);
    useEffect(() => () => (result ? URL.revokeObjectURL(result.url) : undefined), [result]);
    const draw = () =>
        void work(async () => {
            const { hour, north } = app.view.display;
            const seen = kSettings.asSeen.peek();
            const options = { ...optionsNow(), ...(seen ? sunOptions(hour.peek(), north.peek()) : {}) };
            const fields = { objects, camera: seen ? eyeOf(app.view.camera()) : undefined, options, file };
            if (await writing(app, file, (overwrite) => app.engine.request("picture", { ...fields, overwrite }))) {
                setResult({ file, url: URL.createObjectURL(await app.engine.file(file)) });
            }
        });
    if (result) {
        const again = () => {
            setResult(null);
            setTyped(null);
            proposeName();
        };
        return <ResultDialog app={app} result={result} again={again} end={end} />;
    }
    return (
        <Dialog
            title="Image by the path tracer"
            wide
            close={busy ? () => app.engine.cancel() : end}
            accept={wrong || busy ? undefined : draw}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={wrong !== "" || busy}>
                        Draw
                    </button>
                    {busy ? (
                        <button type="button" onClick={() => app.engine.cancel()}>
                            Stop
                        </button>
                    ) : (
                        <button type="button" onClick={end}>
                            Cancel
                        </button>
                    )}
                </>
            }
        >
            <div class="file-columns">
                <ObjectChecks all={all} chosen={objects} set={setObjects} />
                <div>
                    <label class="file-field">
                        <span>File in the folder</span>
                        <input type="text" value={typed ?? proposed} autofocus spellcheck={false} onInput={(event) => setTyped(event.currentTarget.value)} />
                    </label>
                    <NumberField label="Width" unit="px" value={kSettings.width} low={16} high={16384} step={1} />
                    <NumberField label="Height" unit="px" value={kSettings.height} low={16} high={16384} step={1} />
                    <NumberField label="Rays for each pixel" value={kSettings.samples} low={1} high={4096} step={1} />
                    <CheckField label="Current view; otherwise the complete scene, from the front" value={kSettings.asSeen} />
                    <CheckField label="Ground with shadow" value={kSettings.ground} />
                    <CheckField label="Edges of the faces" value={kSettings.wireframe} />
                    <CheckField label="Transparent background" value={kSettings.transparent} />
                </div>
            </div>
            {busy && <RequestProgress app={app} label="Rendering the image" />}
            <ErrorText text={wrong || errorText} />
        </Dialog>
    );
}

function optionsNow(): Record<string, number | boolean> {
    const { width, height, samples, ground, transparent, wireframe } = kSettings;
    return {
        width: width.peek(),
        height: height.peek(),
        samples: samples.peek(),
        ground: ground.peek(),
        transparent: transparent.peek(),
        wireframe: wireframe.peek(),
    };
}

interface ResultProps {
    app: App;
    result: { file: string; url: string };
    again(): void;
    end(): void;
}

function ResultDialog({ app, result: { file, url }, again, end }: ResultProps): VNode {
    const folder = useValue(app.store.folder);
    const { errorText, work } = useWork();
    return (
        <Dialog
            title={file}
            wide
            close={end}
            buttons={
                <>
                    <button type="button" class="primary" autofocus onClick={end}>
                        Close
                    </button>
                    <button type="button" onClick={() => void work(() => download(app, file))}>
                        Download
                    </button>
                    <button type="button" onClick={again}>
                        Another image
                    </button>
                </>
            }
        >
            <img class="result-picture" src={url} alt={`The image ${file}`} />
            <p class="hint">
                It is in <code>{folder}</code>
            </p>
            <ErrorText text={errorText} />
        </Dialog>
    );
}
