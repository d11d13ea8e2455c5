// A number with a slider and a text field.
import type { VNode } from "preact";
import { useId } from "preact/hooks";
import { FieldError, useNumber } from "../../number_field";

interface Props {
    label: string;
    unit?: string;
    value: number;
    low: number;
    high: number;
    step: number;
    changed(value: number): void;
}

export function Slider({ label, unit, value, low, high, step, changed }: Props): VNode {
    const id = useId();
    const shown = String(Number(value.toPrecision(5)));
    const { field, errorText } = useNumber({ value, shown, step, take: (number, done) => done && changed(number) });
    const name = unit ? `${label} [${unit}]` : label;
    return (
        <div class="slider" role="group" aria-labelledby={id}>
            <span id={id}>{name}</span>
            <input
                type="range"
                aria-label={name}
                min={low}
                max={high}
                step={step}
                value={value}
                onInput={(event) => changed(event.currentTarget.valueAsNumber)}
            />
            <input aria-label={`${name}, typed`} {...field} />
            <FieldError text={errorText} />
        </div>
    );
}
