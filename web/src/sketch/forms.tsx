// Forms next to the panes: views and their cameras, branches, height, and commands for the sketch.
import type { TargetedEvent, VNode } from "preact";
import { useState } from "preact/hooks";
import { FieldError, useNumber } from "../number_field";
import { tracked } from "../use";
import { changeView, removeBranch, removeView, renameBranch, setParent, type Side, type SketchView } from "./model";
import type { SketchWork } from "./work";

type KindOfView = "drawing" | "photograph" | "calibrated" | "colmap" | "turntable";

const kKinds: readonly (readonly [KindOfView, string])[] = [
    ["drawing", "Drawing"],
    ["photograph", "Photograph, level"],
    ["calibrated", "Calibrated camera"],
    ["colmap", "COLMAP"],
    ["turntable", "Turntable (Phenomenal)"],
];
const kSides: readonly Side[] = ["front", "back", "side", "left", "top"];

export function kindOf(view: SketchView): KindOfView {
    return view.photograph
        ? "photograph"
        : view.K
          ? "calibrated"
          : view.colmap !== undefined
            ? "colmap"
            : view.phenomenal !== undefined
              ? "turntable"
              : "drawing";
}

/** Returns a view of another kind with the same name, image and size. */
export function ofKind(view: SketchView, kind: KindOfView): SketchView {
    const { name, image } = view;
    const [width, height] = [view.width ?? 800, view.height ?? 800];
    const size = { width, height };
    const head = { name, ...(image !== undefined ? { image } : {}) };
    const side = view.orthographic ?? view.photograph ?? "front";
    switch (kind) {
        case "drawing":
            return { ...head, ...size, orthographic: side, pixels_per_metre: 100, origin: [width / 2, height * 0.9] };
        case "photograph":
            return { ...head, ...size, photograph: side === "top" ? "front" : side, field_of_view: 67 };
        case "calibrated": {
            const f = Math.max(width, height);
            const K = [
                [f, 0, width / 2],
                [0, f, height / 2],
                [0, 0, 1],
            ];
            return {
                ...head,
                ...size,
                K,
                R: [
                    [1, 0, 0],
                    [0, 0, -1],
                    [0, 1, 0],
                ],
                t: [0, 1, 5],
            };
        }
        case "colmap":
            return { name, image: image ?? "", colmap: "sparse/0" };
        case "turntable":
            return { ...head, phenomenal: "calibration_cameras.json", camera: "side", angle: 0 };
    }
}

/** Converts rows of numbers to text, "1 0 0; 0 1 0; 0 0 1", and back; null if the text is invalid. */
export const rowsText = (rows: readonly (readonly number[])[]): string => rows.map((row) => row.join(" ")).join("; ");
export function rowsOf(text: string): number[][] | null {
    const rows = text.split(";").map((row) =>
        row
            .trim()
            .split(/[\s,]+/)
            .map(Number),
    );
    return rows.every((row) => row.every(Number.isFinite)) ? rows : null;
}

interface FieldProps<T> {
    label: string;
    value: T;
    set(value: T): void;
}

/**
 * The text of a field during typing, so that a redraw of the form does not change it; `commit` receives the text when typing is
 * finished.
 */
function useDraft(value: string, commit: (text: string) => void) {
    const [draft, setDraft] = useState<string | null>(null);
    return {
        value: draft ?? value,
        onInput: (event: TargetedEvent<HTMLInputElement>) => setDraft(event.currentTarget.value),
        onChange: (event: TargetedEvent<HTMLInputElement>) => commit(event.currentTarget.value),
        onBlur: () => setDraft(null),
    };
}

function Line({ label, value, set }: FieldProps<string>): VNode {
    return (
        <label class="tool-field">
            <span>{label}</span>
            <input type="text" spellcheck={false} {...useDraft(value, set)} />
        </label>
    );
}

function Amount({ label, value, set }: FieldProps<number>): VNode {
    const { field, errorText } = useNumber({ value, take: (number, done) => done && set(number) });
    return (
        <>
            <label class="tool-field">
                <span>{label}</span>
                <input {...field} />
            </label>
            <FieldError text={errorText} />
        </>
    );
}

function Choice({ label, value, set, choices }: FieldProps<string> & { choices: readonly (readonly [string, string])[] }): VNode {
    return (
        <label class="tool-field">
            <span>{label}</span>
            <select value={value} onChange={(event) => set(event.currentTarget.value)}>
                {choices.map(([id, text]) => (
                    <option key={id} value={id}>
                        {text}
                    </option>
                ))}
            </select>
        </label>
    );
}

function CameraFields({ view, set }: { view: SketchView; set(view: SketchView): void }): VNode {
    const sides = kSides.filter((side) => side !== "top" || view.orthographic).map((side) => [side, side] as const);
    switch (kindOf(view)) {
        case "drawing":
            return (
                <>
                    <Choice
                        label="Seen from"
                        value={view.orthographic ?? "front"}
                        choices={sides}
                        set={(side) => set({ ...view, orthographic: side as Side })}
                    />
                    <Amount
                        label="Pixels per metre, 0 = from the height"
                        value={view.pixels_per_metre ?? 0}
                        set={(scale) => {
                            const { pixels_per_metre: _, origin, ...rest } = view;
                            const at = origin ?? [(view.width ?? 800) / 2, (view.height ?? 800) * 0.9];
                            set(scale > 0 ? { ...rest, pixels_per_metre: scale, origin: at } : rest);
                        }}
                    />
                    {view.origin && (
                        <Line
                            label="Pixel of the origin"
                            value={view.origin.join(" ")}
                            set={(text) => {
                                const row = rowsOf(text)?.[0];
                                if (row?.length === 2) {
                                    set({ ...view, origin: [row[0], row[1]] });
                                }
                            }}
                        />
                    )}
                </>
            );
        case "photograph":
            return (
                <>
                    <Choice
                        label="Taken from"
                        value={view.photograph ?? "front"}
                        choices={sides}
                        set={(side) => set({ ...view, photograph: side as Exclude<Side, "top"> })}
                    />
                    <Amount label="Field of view [°]" value={view.field_of_view ?? 67} set={(angle) => set({ ...view, field_of_view: angle })} />
                </>
            );
        case "calibrated":
            return (
                <>
                    {(["K", "R"] as const).map((key) => (
                        <Line
                            key={key}
                            label={`${key}, rows with ;`}
                            value={rowsText(view[key] ?? [])}
                            set={(text) => {
                                const rows = rowsOf(text);
                                if (rows?.length === 3 && rows.every((row) => row.length === 3)) {
                                    set({ ...view, [key]: rows });
                                }
                            }}
                        />
                    ))}
                    <Line
                        label="t [m]"
                        value={(view.t ?? []).join(" ")}
                        set={(text) => {
                            const row = rowsOf(text)?.[0];
                            if (row?.length === 3) {
                                set({ ...view, t: row });
                            }
                        }}
                    />
                </>
            );
        case "colmap":
            return <Line label="Folder of cameras.txt" value={view.colmap ?? ""} set={(colmap) => set({ ...view, colmap })} />;
        case "turntable":
            return (
                <>
                    <Line label="File of cameras" value={view.phenomenal ?? ""} set={(phenomenal) => set({ ...view, phenomenal })} />
                    <Line label="Camera" value={view.camera ?? ""} set={(camera) => set({ ...view, camera })} />
                    <Amount label="Rotation [°]" value={view.angle ?? 0} set={(angle) => set({ ...view, angle })} />
                </>
            );
    }
}

const ViewForm = tracked(({ work, index }: { work: SketchWork; index: number }) => {
    const sketch = work.sketch.value;
    const view = sketch.views[index];
    const pictures = work.files.value.filter((name) => /\.(png|jpe?g)$/i.test(name) || name === view.image);
    const set = (next: SketchView) => {
        work.set(changeView(work.sketch.peek(), index, next));
        void work.rebuild();
    };
    return (
        <details class="sketch-view">
            <summary>View {view.name}</summary>
            <Line
                label="Name"
                value={view.name}
                set={(name) => name.trim() !== "" && !sketch.views.some((other) => other.name === name) && set({ ...view, name })}
            />
            <Choice label="Kind" value={kindOf(view)} choices={kKinds} set={(kind) => set(ofKind(view, kind as KindOfView))} />
            <CameraFields view={view} set={set} />
            <Choice
                label="Image"
                value={view.image ?? ""}
                choices={[["", "none"], ...pictures.map((name) => [name, name] as const)]}
                set={(image) => {
                    const { image: _, ...bare } = view;
                    return image === "" ? set(bare) : void work.setPicture(index, image);
                }}
            />
            <label class="tool-field">
                <span>Replace the image</span>
                <input
                    type="file"
                    accept="image/png,image/jpeg"
                    aria-label={`Replace the image of view ${view.name}`}
                    onChange={(event) => {
                        const file = event.currentTarget.files?.[0];
                        if (file) {
                            void work.addPicture(index, file);
                        }
                    }}
                />
            </label>
            <button
                type="button"
                disabled={sketch.views.length <= 2}
                onClick={() => {
                    work.set(removeView(work.sketch.peek(), index));
                    void work.rebuild();
                }}
            >
                Remove the view
            </button>
        </details>
    );
});

const BranchForm = tracked(({ work }: { work: SketchWork }) => {
    const { branches } = work.sketch.value;
    const chosen = work.chosen.value;
    const branch = branches.find(({ name }) => name === chosen);
    const fit = work.fits.value.find(({ name }) => name === chosen);
    const edit = (next: ReturnType<typeof removeBranch>) => {
        work.set(next);
        void work.rebuild();
    };
    const parents = [["", "none: a stem"] as const, ...branches.filter(({ name }) => name !== chosen).map(({ name }) => [name, name] as const)];
    return (
        <>
            <Choice
                label="Branch"
                value={chosen ?? ""}
                choices={[["", "a new branch"], ...branches.map(({ name }) => [name, name] as const)]}
                set={(name) => {
                    work.chosen.value = name === "" ? null : name;
                    work.point.value = -1;
                }}
            />
            {branch && (
                <>
                    <Line
                        label="Name"
                        value={branch.name}
                        set={(name) => {
                            edit(renameBranch(work.sketch.peek(), branch.name, name));
                            work.chosen.value = work.sketch.peek().branches.some((other) => other.name === name) ? name : branch.name;
                        }}
                    />
                    <Choice
                        label="Parent branch"
                        value={branch.parent ?? ""}
                        choices={parents}
                        set={(parent) => edit(setParent(work.sketch.peek(), branch.name, parent === "" ? null : parent))}
                    />
                    {fit && <p class={fit.refused ? "error" : "hint"}>{fit.refused || `Found: ${fit.length_m.toPrecision(3)} m.`}</p>}
                    <button type="button" onClick={() => edit(removeBranch(work.sketch.peek(), branch.name))}>
                        Delete the branch
                    </button>
                </>
            )}
        </>
    );
});

interface Props {
    work: SketchWork;
    done(): void; // called when the sketch has been added to the scene
    leave(): void;
}

export const SketchForms = tracked(({ work, done, leave }: Props) => {
    const sketch = work.sketch.value;
    const refused = work.fits.value.filter((fit) => fit.refused);
    const files = work.files.value.filter((name) => name.endsWith(".sketch.json"));
    return (
        <>
            <BranchForm work={work} />
            {work.errorText.value && <p class="error">{work.errorText.value}</p>}
            {refused.map((fit) => (
                <p key={fit.name} class="error">{`${fit.name}: ${fit.refused}`}</p>
            ))}
            <Amount
                label="Width of strokes [px]"
                value={Number(work.width.value.toPrecision(3))}
                set={(width) => {
                    work.width.value = Math.max(width, 0.5);
                }}
            />
            <Amount
                label="Height of the tree [m], 0 = from the scale"
                value={sketch.height ?? 0}
                set={(height) => {
                    const { height: _, ...rest } = work.sketch.peek();
                    work.set(height > 0 ? { ...rest, height } : rest);
                    void work.rebuild();
                }}
            />
            {sketch.views.map((_, index) => (
                <ViewForm key={index} work={work} index={index} />
            ))}
            <div class="tool-row">
                <button
                    type="button"
                    onClick={() => {
                        const name = `view ${sketch.views.length + 1}`;
                        work.set({ ...sketch, views: [...sketch.views, ofKind({ name, orthographic: "left" }, "drawing")] });
                    }}
                >
                    Add a view
                </button>
                <button type="button" disabled={!sketch.views.every(({ image }) => image)} onClick={() => void work.trace()}>
                    Trace the images
                </button>
                <button type="button" disabled={!work.canUndo.value} onClick={() => work.undo()}>
                    Undo stroke
                </button>
                <button type="button" disabled={!work.canRedo.value} onClick={() => work.redo()}>
                    Redo stroke
                </button>
            </div>
            {files.length > 0 && (
                <Choice
                    label="Open"
                    value=""
                    choices={[["", "a sketch of the folder"], ...files.map((file) => [file, file] as const)]}
                    set={(file) => void work.open(file)}
                />
            )}
            <Line
                label="Tree"
                value={work.name.value}
                set={(name) => {
                    work.name.value = name;
                }}
            />
            <div class="tool-row">
                <button type="button" class="primary" disabled={sketch.branches.length === 0} onClick={async () => (await work.commit()) && done()}>
                    Add to the scene
                </button>
                <button type="button" onClick={leave}>
                    Close the sketch
                </button>
            </div>
        </>
    );
});
