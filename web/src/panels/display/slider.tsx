// A number by a slider and by typing.
import type { VNode } from "preact";
import { useId } from "preact/hooks";

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
    const take = (event: Event) => {
        const typed = (event.currentTarget as HTMLInputElement).valueAsNumber;
        if (Number.isFinite(typed)) {
            changed(typed);
        }
    };
    const name = unit ? `${label} [${unit}]` : label;
    return (
        <div class="slider" role="group" aria-labelledby={id}>
            <span id={id}>{name}</span>
            <input type="range" aria-label={name} min={low} max={high} step={step} value={value} onInput={take} />
            <input type="number" aria-label={`${name}, typed`} step="any" value={String(Number(value.toPrecision(5)))} onChange={take} />
        </div>
    );
}
