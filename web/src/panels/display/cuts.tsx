// Planes through the scene: a section that opens it, and a slice through the field of a solid.
import type { VNode } from "preact";
import { useEffect } from "preact/hooks";
import type { App } from "../../app";
import type { SceneObject } from "../../protocol";
import { useValue } from "../../use";
import type { Axis, Slice } from "../../view/display";
import { Slider } from "./slider";

const kAxes: readonly Axis[] = ["x", "y", "z"];
const kSteps = 400; // of a slider

/** The minimum and maximum coordinates of objects along an axis; one metre if there are no objects. */
export function extentAlong(objects: readonly Pick<SceneObject, "bounds">[], axis: Axis): [number, number] {
    const at = kAxes.indexOf(axis);
    const full = objects.filter(({ bounds }) => bounds[at + 3] >= bounds[at]);
    if (full.length === 0) {
        return [0, 1];
    }
    return [Math.min(...full.map(({ bounds }) => bounds[at])), Math.max(...full.map(({ bounds }) => bounds[at + 3]))];
}

const middleOf = ([low, high]: [number, number]): number => Number(((low + high) / 2).toPrecision(4));

interface PlaceProps {
    axis: Axis;
    at: number;
    range: [number, number];
    changed(axis: Axis, at?: number): void; // without a position: an axis was chosen
}

function PlaceFields({ axis, at, range: [low, high], changed }: PlaceProps): VNode {
    return (
        <>
            <div class="tool-field">
                <span>Axis</span>
                <div class="segments" role="group" aria-label="Axis of the plane">
                    {kAxes.map((one) => (
                        <button key={one} type="button" aria-pressed={one === axis} onClick={() => changed(one)}>
                            {one.toUpperCase()}
                        </button>
                    ))}
                </div>
            </div>
            <Slider label="Place" unit="m" value={at} low={low} high={high} step={(high - low) / kSteps} changed={(value) => changed(axis, value)} />
        </>
    );
}

interface CheckProps {
    label: string;
    value: boolean;
    disabled?: boolean;
    changed(value: boolean): void;
}

function Check({ label, value, disabled, changed }: CheckProps): VNode {
    return (
        <label class="tool-check">
            <input type="checkbox" checked={value} disabled={disabled} onChange={(event) => changed(event.currentTarget.checked)} />
            <span>{label}</span>
        </label>
    );
}

export function SectionFields({ app }: { app: App }): VNode {
    const { section: signal } = app.view.display;
    const section = useValue(signal);
    const { objects } = useValue(app.store.state);
    const range = extentAlong(objects, section.axis);
    const isOutside = section.at < range[0] || section.at > range[1];
    // The side towards the camera is removed, so that the cut is visible.
    const facing = (axis: Axis, at: number) => app.view.camera().position[axis] < at;
    const turn = (on: boolean) => {
        const at = on && isOutside ? middleOf(range) : section.at;
        signal.value = { ...section, on, at, flipped: on ? facing(section.axis, at) : section.flipped };
    };
    const move = (axis: Axis, typed?: number) => {
        const at = typed ?? middleOf(extentAlong(objects, axis));
        signal.value = { ...section, axis, at, flipped: axis === section.axis ? section.flipped : facing(axis, at) };
    };
    return (
        <>
            <Check label="Cut the scene open" value={section.on} changed={turn} />
            {section.on && (
                <>
                    <PlaceFields axis={section.axis} at={section.at} range={range} changed={move} />
                    <Check label="Keep the other side" value={section.flipped} changed={(flipped) => void (signal.value = { ...section, flipped })} />
                    <p class="hint">Drag the ball in the centre of the plane to move it.</p>
                </>
            )}
        </>
    );
}

/** The solid of the slice: the selected one, otherwise the last one shown, otherwise the newest. */
export function slicedSolid(app: Pick<App, "store">, last: string): SceneObject | undefined {
    const { objects } = app.store.state.value;
    const { object } = app.store.selection.value;
    const solids = objects.filter(({ kind }) => kind === "solid");
    const named = (name: string | undefined) => solids.find((solid) => solid.name === name);
    return (object?.kind === "solid" ? named(object.name) : undefined) ?? named(last) ?? solids[solids.length - 1];
}

const withMargin = ([low, high]: [number, number]): [number, number] => [low - (high - low) * 0.1, high + (high - low) * 0.1];

export function SliceFields({ app }: { app: App }): VNode {
    const { slice: signal } = app.view.display;
    const slice = useValue(signal);
    useValue(app.store.selection);
    useValue(app.store.state);
    const solid = slicedSolid(app, slice.solid);
    const name = solid?.name ?? "";
    const range = (axis: Axis) => withMargin(extentAlong(solid ? [solid] : [], axis)); // the field extends beyond the surface
    const placed = ({ axis, at }: Slice) => {
        const [low, high] = range(axis);
        return at >= low && at <= high ? at : middleOf([low, high]);
    };
    const change = (change: Partial<Slice>) => {
        const next = { ...slice, solid: name, ...change };
        signal.value = { ...next, at: placed(next) };
    };
    useEffect(() => {
        if (slice.on && slice.solid !== name) {
            change({}); // another solid was selected
        }
    }, [name]);
    if (!solid) {
        return <p class="hint">There is no solid to show a field of.</p>;
    }
    return (
        <>
            <Check label={`Show the field of ${name}`} value={slice.on} changed={(on) => change({ on })} />
            {slice.on && (
                <>
                    <PlaceFields
                        axis={slice.axis}
                        at={slice.at}
                        range={range(slice.axis)}
                        changed={(axis, at) => change({ axis, at: at ?? middleOf(range(axis)) })}
                    />
                    <Slider
                        label="Lines"
                        value={slice.lines}
                        low={0}
                        high={30}
                        step={1}
                        changed={(lines) => change({ lines: Math.min(Math.max(Math.round(lines), 0), 100) })}
                    />
                    <p class="hint">Thin lines have equal values; the bright one is the surface.</p>
                </>
            )}
        </>
    );
}
