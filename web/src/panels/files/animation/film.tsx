// Films as files: images, or animated surfaces for other programs.
import { type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { App } from "../../../app";
import { ChoiceField, NumberField } from "../../../tools/kit/fields";
import { useValue } from "../../../use";
import { barkOf } from "../../../view/sources";
import { openDialog, Dialog, ErrorText, useWork } from "../dialog";
import { bytesText, download, nameError, withEnding, writing } from "../folder";
import { RequestProgress } from "../progress";
import { type Film, frameCount, motionFields } from "./timeline";

type Ending = ".gif" | ".png" | ".glb" | ".usda" | ".ply" | ".obj" | ".mp4";

const kEndings: readonly (readonly [Ending, string])[] = [
    [".gif", "GIF: an animated image"],
    [".png", "PNG: an image for each frame"],
    [".mp4", "MP4: a film, requires ffmpeg"],
    [".glb", "GLB: the surface with its motion, for games and the web"],
    [".usda", "USD: the surface with its motion, for film"],
    [".ply", "PLY: a surface for each frame"],
    [".obj", "OBJ: a surface for each frame"],
];

const kPictures: ReadonlySet<Ending> = new Set<Ending>([".gif", ".png", ".mp4"]);
const kSeries: ReadonlySet<Ending> = new Set<Ending>([".png", ".ply", ".obj"]);

/** The last choice, kept while the page is open. */
const kEnding: Signal<Ending> = signal(".gif");
const kWidth = signal(480);
const kHeight = signal(480);
const kSamples = signal(4);
const kLevels = signal(1);

interface FilmResult {
    files: readonly string[];
    bytes: number;
    message: string;
}

export async function exportFilm(app: App, film: Film): Promise<void> {
    await openDialog<null>((end) => <FilmDialog app={app} film={film} end={() => end(null)} />);
}

function FilmDialog({ app, film, end }: { app: App; film: Film; end(): void }): VNode {
    const ending = useValue(kEnding);
    const [typed, setTyped] = useState(film.tree);
    const [result, setResult] = useState<FilmResult | null>(null);
    const { busy, errorText, work } = useWork();
    const choices = kEndings.filter(([one]) => !film.grow || one !== ".glb"); // its faces differ in each frame
    const chosen = choices.some(([one]) => one === ending) ? ending : ".gif";
    const file = withEnding(typed.trim(), chosen);
    const wrong = nameError(file);
    const write = () =>
        void work(async () => {
            const { options, ...motion } = motionFields(film);
            const picture = kPictures.has(chosen) ? { width: kWidth.peek(), height: kHeight.peek(), samples: kSamples.peek() } : {};
            const fields = { ...motion, options: { ...options, ...picture, levels: kLevels.peek() }, material: barkOf(app.store, film.tree), file };
            const done = await writing(
                app,
                file,
                (overwrite) => app.engine.request<FilmResult>("animate", { ...fields, overwrite }),
                kSeries.has(chosen) ? seriesOf(file, chosen) : undefined,
            );
            if (done) {
                setResult(done);
            }
        });
    if (result) {
        return <ResultDialog app={app} result={result} end={end} />;
    }
    return (
        <Dialog
            title="Export the film"
            close={busy ? () => app.engine.cancel() : end}
            accept={wrong || busy ? undefined : write}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={wrong !== "" || busy}>
                        Export
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
            <p class="hint">{`${film.duration} s of ${film.tree}, ${frameCount(film)} frames`}</p>
            <ChoiceField label="Format" value={kEnding} choices={choices} />
            <label class="file-field">
                <span>File in the folder</span>
                <input type="text" value={typed} autofocus spellcheck={false} onInput={(event) => setTyped(event.currentTarget.value)} />
            </label>
            <NumberField label="Subdivisions of the surface" value={kLevels} low={0} high={4} step={1} />
            {kPictures.has(chosen) && (
                <>
                    <NumberField label="Width" unit="px" value={kWidth} low={16} high={4096} step={1} />
                    <NumberField label="Height" unit="px" value={kHeight} low={16} high={4096} step={1} />
                    <NumberField label="Rays for each pixel" value={kSamples} low={1} high={256} step={1} />
                </>
            )}
            {busy && <RequestProgress app={app} label="Making the frames" />}
            <ErrorText text={wrong || errorText} />
        </Dialog>
    );
}

/** The names of a series of frames: NAME_0000.png and so on. */
function seriesOf(file: string, ending: Ending): RegExp {
    const stem = file.slice(0, file.length - ending.length).replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
    return new RegExp(`^${stem}_\\d+\\${ending}$`);
}

function ResultDialog({ app, result, end }: { app: App; result: FilmResult; end(): void }): VNode {
    const folder = useValue(app.store.folder);
    const [url, setUrl] = useState("");
    const { errorText, work } = useWork();
    const [first] = result.files;
    const isPicture = /\.(gif|png)$/.test(first);
    useEffect(() => {
        if (isPicture) {
            void work(async () => setUrl(URL.createObjectURL(await app.engine.file(first))));
        }
    }, []);
    useEffect(() => () => (url ? URL.revokeObjectURL(url) : undefined), [url]);
    const names = result.files.length > 1 ? `${first} to ${result.files.at(-1)}` : first;
    return (
        <Dialog
            title={`The film ${names}`}
            wide
            close={end}
            buttons={
                <>
                    <button type="button" class="primary" autofocus onClick={end}>
                        Close
                    </button>
                    <button type="button" onClick={() => void work(() => download(app, first))}>
                        {result.files.length > 1 ? "Download the first" : "Download"}
                    </button>
                </>
            }
        >
            {url && <img class="result-picture" src={url} alt={`The film ${first}`} />}
            <p>
                {`${result.message.trim()}. ${bytesText(result.bytes)} in the folder `}
                <code>{folder}</code>
            </p>
            <ErrorText text={errorText} />
        </Dialog>
    );
}
