// Export of objects as files of the folder, and the check of the written surface.
import type { Signal } from "@preact/signals-core";
import { signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import type { App } from "../../app";
import type { Argument, ObjectName } from "../../protocol";
import { displayName } from "../../script/commands";
import { useValue } from "../../use";
import { Figures } from "../display/check_panel";
import { type Figures as Checked, grouped } from "../display/figures";
import { openDialog, Dialog, ErrorText, useWork } from "./dialog";
import { baseOf, bytesText, download, nameError, withEnding, writing } from "./folder";
import { type Format, formatsOf, isWritten, kHoldsLabels } from "./formats";
import { ObjectChecks } from "./object_checks";

interface Written {
    object: ObjectName;
    file: string;
    bytes: number;
    checked: { good: boolean; verdict: string; figures: Checked } | null; // null: there is no surface to check
}

interface Chosen {
    objects: readonly ObjectName[];
    format: Format | undefined;
    files: readonly string[]; // of each object
    surface: Record<string, string>; // options of `mesh`
}

/** The last choice, kept while the page is open. */
const kSurface: Signal<Record<string, string>> = signal({});
const kFormat = signal("surface.glb");

// The most important options of `mesh`; the others have good defaults, and are available in `mesh` of the scene.
const kSurfaceOptions = ["method", "levels", "fit", "overlaps"];

export async function exportObjects(app: App): Promise<void> {
    await openDialog<null>((end) => <ExportDialog app={app} end={() => end(null)} />);
}

async function writeObject(app: App, object: ObjectName, file: string, { format, surface }: Chosen): Promise<Written | null> {
    const isSurface = format?.holds === "surface" && object.kind === "skeleton";
    const options = isSurface ? { surface } : {};
    const as = object.kind === "skeleton" ? { as: format?.holds } : {};
    const reply = await writing(app, file, (overwrite) =>
        app.engine.request<{ file: string; bytes: number }>("export", { ...object, file, overwrite, ...as, ...options }),
    );
    const checked = reply && format?.holds === "surface" ? await app.engine.request<NonNullable<Written["checked"]>>("check", { ...object, ...options }) : null;
    return reply && { object, file: reply.file, bytes: reply.bytes, checked };
}

function ExportDialog({ app, end }: { app: App; end(): void }): VNode {
    const all = app.store.state.peek().objects.filter(({ kind }) => isWritten(kind));
    const { object } = app.store.selection.peek();
    const first = all.find(({ kind, name }) => kind === object?.kind && name === object.name) ?? all.at(-1);
    const [names, setNames] = useState<readonly ObjectName[]>(first ? [{ kind: first.kind, name: first.name }] : []);
    const [typed, setTyped] = useState<string | null>(null); // name of the file; null: the name of the object
    const [written, setWritten] = useState<readonly Written[] | null>(null);
    const { busy, errorText, work } = useWork();
    const wanted = useValue(kFormat);
    const surface = useValue(kSurface);
    const formats = formatsOf(names.map(({ kind }) => kind));
    const format = formats.find(({ id }) => id === wanted) ?? formats[0];
    const ending = format?.ending ?? "";
    const files = names.length === 1 && typed !== null ? [withEnding(typed.trim(), ending)] : names.map(({ name }) => name + ending);
    const twice = files.length > new Set(files).size ? "Two of these objects have the same name; export them one after the other." : "";
    const none = names.length === 0 ? "Choose the objects to export." : format ? "" : "No format supports all of these; choose objects of one kind.";
    const wrong = none || twice || (files.map(nameError).find(Boolean) ?? "");
    const write = () =>
        void work(async () => {
            const done: Written[] = [];
            for (const [at, name] of names.entries()) {
                const one = await writeObject(app, name, files[at], { objects: names, format, files, surface });
                done.push(...(one ? [one] : []));
            }
            if (done.length > 0) {
                setWritten(done);
            }
        });
    if (written) {
        return <WrittenDialog app={app} written={written} again={() => setWritten(null)} end={end} />;
    }
    return (
        <Dialog
            title="Export"
            wide
            close={end}
            accept={wrong || busy ? undefined : write}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={wrong !== "" || busy}>
                        {busy ? "Exporting…" : "Export"}
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
                <ObjectChecks all={all} chosen={names} set={setNames} />
                <div>
                    <FormatField formats={formats} format={format} />
                    {names.length === 1 && (
                        <label class="file-field">
                            <span>File in the folder</span>
                            <input
                                type="text"
                                value={typed ?? names[0].name}
                                spellcheck={false}
                                onFocus={(event) => event.currentTarget.select()}
                                onInput={(event) => setTyped(event.currentTarget.value)}
                            />
                        </label>
                    )}
                    <p class="hint">{wrong ? "" : `Writes ${files.join(", ")}.`}</p>
                    {format?.holds === "surface" && names.some(({ kind }) => kind === "skeleton") && <SurfaceOptions app={app} />}
                </div>
            </div>
            <ErrorText text={wrong || errorText} />
        </Dialog>
    );
}

function FormatField({ formats, format }: { formats: readonly Format[]; format: Format | undefined }): VNode {
    const holds = [...new Set(formats.map((one) => one.holds))];
    return (
        <label class="file-field">
            <span>Format</span>
            <select value={format?.id} autofocus onChange={(event) => (kFormat.value = event.currentTarget.value)}>
                {holds.map((content) => (
                    <optgroup key={content} label={kHoldsLabels[content]}>
                        {formats
                            .filter((one) => one.holds === content)
                            .map(({ id, label }) => (
                                <option key={id} value={id}>
                                    {label}
                                </option>
                            ))}
                    </optgroup>
                ))}
            </select>
        </label>
    );
}

/** The options of `mesh` for the surface, from the schema. */
function SurfaceOptions({ app }: { app: App }): VNode {
    const mesh = app.store.schema.peek().find(({ name }) => name === "mesh");
    const options = kSurfaceOptions.flatMap((wanted) => mesh?.arguments.find(({ name }) => name === wanted) ?? []);
    return (
        <fieldset>
            <legend>Surface of skeletons</legend>
            {options.map((option) => (
                <SurfaceOption key={option.name} option={option} />
            ))}
        </fieldset>
    );
}

function SurfaceOption({ option }: { option: Argument }): VNode {
    const { name, help, low = 0, high = 6 } = option;
    const chosen = useValue(kSurface);
    const choices = option.choices ?? Array.from({ length: Math.min(high, 12) - low + 1 }, (_, n) => String(low + n));
    const set = (value: string) => {
        const { [name]: _, ...rest } = kSurface.peek();
        kSurface.value = value === option.default ? rest : { ...rest, [name]: value };
    };
    return (
        <label class="file-field" title={help}>
            <span>{displayName(name)}</span>
            <select value={chosen[name] ?? option.default} onChange={(event) => set(event.currentTarget.value)}>
                {choices.map((choice) => (
                    <option key={choice} value={choice}>
                        {choice}
                    </option>
                ))}
            </select>
        </label>
    );
}

interface WrittenProps {
    app: App;
    written: readonly Written[];
    again(): void;
    end(): void;
}

function WrittenDialog({ app, written, again, end }: WrittenProps): VNode {
    return (
        <Dialog
            title="Exported"
            wide
            close={end}
            buttons={
                <>
                    <button type="button" class="primary" autofocus onClick={end}>
                        Close
                    </button>
                    <button type="button" onClick={again}>
                        Export more
                    </button>
                </>
            }
        >
            {written.map((one) => (
                <WrittenFile key={one.file} app={app} written={one} />
            ))}
        </Dialog>
    );
}

function WrittenFile({ app, written: { object, file, bytes, checked } }: { app: App; written: Written }): VNode {
    const folder = useValue(app.store.folder);
    const { errorText, work } = useWork();
    return (
        <section class="written" aria-label={file}>
            <h3>
                {file} <span class="hint">{`${object.kind} ${object.name}, ${bytesText(bytes)}`}</span>
            </h3>
            {checked && (
                <p class={checked.good ? "verdict good" : "verdict bad"}>
                    <span aria-hidden="true">{checked.good ? "✓" : "!"}</span> {checked.verdict}
                </p>
            )}
            <p class="hint">
                It is in <code>{folder}</code>
            </p>
            <div class="tool-row">
                <button type="button" onClick={() => void work(() => download(app, file))}>
                    Download {baseOf(file)}
                </button>
            </div>
            <ErrorText text={errorText} />
            {checked && (
                <details>
                    <summary>Figures of the check</summary>
                    {grouped(checked.figures).map((group) => (
                        <Figures key={group.title} group={group} />
                    ))}
                </details>
            )}
        </section>
    );
}
