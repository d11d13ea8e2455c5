// One step: its button, its current result, and its settings below.
import type { ComponentChildren } from "preact";
import type { App } from "../../app";
import type { ObjectName } from "../../protocol";
import { tracked } from "../../use";
import { keyOf } from "../../view/object_view";
import { type Card, setShown } from "./card";
import { type GrowthModel, type StepName } from "./model";

/** The arguments that are shown at once. */
export const kMain: Record<string, readonly string[]> = {
    "pointset generate": ["solid", "count", "pattern", "density"],
    "pointset near": ["mesh", "count", "low", "high"],
    "pointset thin": ["points", "solid", "percent"],
    "pointset densify": ["points", "solid", "count", "distance"],
    grow: ["points", "influence_radius", "kill_radius", "step", "tropism_weight"],
    sprout: ["seasons", "branching_angle", "apical_control", "vigour", "branch_tropism"],
    extract: ["up", "method", "voxel"],
    mesh: ["tree", "method", "levels"],
};

interface StepProps {
    model: GrowthModel;
    step: StepName;
    mark: string; // "1"
    title: string;
    summary: string; // current result, or missing input
    done: boolean;
    button: string;
    run(): void;
    disabled: boolean;
    notice?: ComponentChildren; // visible even if the settings are folded
    children: ComponentChildren;
}

export const Step = tracked(({ model, step, mark, title, summary, done, button, run, disabled, notice, children }: StepProps) => {
    const isOpen = model.open.value === step;
    return (
        <li class={done ? "step done" : "step"}>
            <h3>
                <button
                    type="button"
                    class="step-title"
                    aria-expanded={isOpen}
                    aria-controls={`step-${step}`}
                    onClick={() => {
                        model.open.value = isOpen ? null : step;
                    }}
                >
                    <span class="step-mark" aria-hidden="true">
                        {done ? "✓" : mark}
                    </span>
                    <span class="step-name">
                        {title}
                        <span class="hint">{summary}</span>
                    </span>
                </button>
            </h3>
            <button
                type="button"
                class={done || step === "scan" ? "step-run" : "step-run primary"}
                disabled={disabled}
                onClick={() => {
                    model.open.value = step;
                    run();
                }}
            >
                {button}
            </button>
            {notice}
            <div id={`step-${step}`} hidden={!isOpen}>
                {isOpen && children}
            </div>
        </li>
    );
});

/** Selects one of several commands of a card. */
export const CommandChoice = tracked(({ card, choices, label }: { card: Card; choices: readonly (readonly [string, string])[]; label: string }) => {
    return (
        <div class="tool-row" role="group" aria-label={label}>
            {choices.map(([command, text]) => (
                <button key={command} type="button" aria-pressed={card.command.value === command} onClick={() => card.choose(command)}>
                    {text}
                </button>
            ))}
        </div>
    );
});

export const ShownBox = tracked(({ app, object, label }: { app: App; object: ObjectName | null; label: string }) => {
    const isThere = app.store.state.value.objects.some((one) => one.kind === object?.kind && one.name === object.name);
    return object && isThere ? (
        <label class="tool-check">
            <input
                type="checkbox"
                checked={!app.store.hidden.value.has(keyOf(object))}
                onChange={(event) => setShown(app, object, event.currentTarget.checked)}
            />
            <span>{label}</span>
        </label>
    ) : null;
});

/** "1,987 points" */
export const count = (value: number, of: string) => `${value.toLocaleString("en")} ${of}`;
