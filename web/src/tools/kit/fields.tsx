// Fields of the panels of tools.
import { signal, type Signal } from "@preact/signals-core";
import type { ComponentChildren, VNode } from "preact";
import { FieldError, useNumber } from "../../number_field";
import { useValue } from "../../use";
import type { Axis } from "./typed_input";

interface FieldProps {
    label: string;
    unit?: string;
    children: ComponentChildren;
}

function Field({ label, unit, children }: FieldProps): VNode {
    return (
        <label class="tool-field">
            <span>{unit ? `${label} [${unit}]` : label}</span>
            {children}
        </label>
    );
}

interface NumberProps {
    label: string;
    value: Signal<number>;
    unit?: string;
    low?: number;
    high?: number;
    step?: number;
    changed?(): void;
}

export function NumberField({ label, value, unit, low, high, step, changed }: NumberProps): VNode {
    const now = useValue(value);
    const { field, errorText } = useNumber({
        value: now,
        shown: String(Number(now.toPrecision(6))),
        low,
        high,
        step,
        take: (number) => {
            if (number !== value.peek()) {
                value.value = number;
                changed?.();
            }
        },
    });
    return (
        <>
            <Field label={label} unit={unit}>
                <input {...field} />
            </Field>
            <FieldError text={errorText} />
        </>
    );
}

interface TextProps {
    label: string;
    value: Signal<string>;
    changed?(): void;
}

export function TextField({ label, value, changed }: TextProps): VNode {
    const now = useValue(value);
    return (
        <Field label={label}>
            <input
                type="text"
                value={now}
                spellcheck={false}
                onInput={(event) => {
                    value.value = event.currentTarget.value;
                    changed?.();
                }}
            />
        </Field>
    );
}

interface ChoiceProps<T extends string> {
    label: string;
    value: Signal<T>;
    choices: readonly (readonly [T, string])[];
    changed?(): void;
}

export function ChoiceField<T extends string>({ label, value, choices, changed }: ChoiceProps<T>): VNode {
    const now = useValue(value);
    return (
        <Field label={label}>
            <select
                value={now}
                onChange={(event) => {
                    value.value = event.currentTarget.value as T;
                    changed?.();
                }}
            >
                {choices.map(([name, text]) => (
                    <option key={name} value={name}>
                        {text}
                    </option>
                ))}
            </select>
        </Field>
    );
}

interface CheckProps {
    label: string;
    value: Signal<boolean>;
    changed?(): void;
}

export function CheckField({ label, value, changed }: CheckProps): VNode {
    const now = useValue(value);
    return (
        <label class="tool-check">
            <input
                type="checkbox"
                checked={now}
                onChange={(event) => {
                    value.value = event.currentTarget.checked;
                    changed?.();
                }}
            />
            <span>{label}</span>
        </label>
    );
}

export function Button({ label, run, disabled }: { label: string; run(): void; disabled?: boolean }): VNode {
    return (
        <button type="button" disabled={disabled} onClick={run}>
            {label}
        </button>
    );
}

/** Buttons X, Y and Z, equivalent to the keys. */
export function AxisButtons({ choose }: { choose(axis: Axis): void }): VNode {
    return (
        <div class="tool-row" role="group" aria-label="Axis">
            {(["x", "y", "z"] as const).map((axis) => (
                <Button key={axis} label={axis.toUpperCase()} run={() => choose(axis)} />
            ))}
        </div>
    );
}

/** Three numbers. */
export function pointSignals(first: readonly [number, number, number]): [Signal<number>, Signal<number>, Signal<number>] {
    return [signal(first[0]), signal(first[1]), signal(first[2])];
}

export function PointField({ label, value, changed }: { label: string; value: readonly Signal<number>[]; changed?(): void }): VNode {
    return (
        <fieldset class="tool-point">
            <legend>{label} [m]</legend>
            {value.map((part, i) => (
                <NumberField key={i} label={"XYZ"[i]} value={part} changed={changed} />
            ))}
        </fieldset>
    );
}
