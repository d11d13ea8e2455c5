// Numbers in the rows of the timeline.
import type { VNode } from "preact";

interface AmountProps {
    label: string;
    value: number;
    low: number;
    high: number;
    step: number | "any";
    title?: string;
    set(value: number): void;
}

/** A number of a film, taken when it is whole. */
export function Amount({ label, value, low, high, step, title, set }: AmountProps): VNode {
    return (
        <label title={title}>
            <span>{label}</span>
            <input
                type="number"
                value={value}
                min={low}
                max={high}
                step={step}
                onChange={(event) => {
                    const typed = event.currentTarget.valueAsNumber;
                    if (typed >= low && typed <= high) {
                        set(typed);
                    } else {
                        event.currentTarget.value = String(value);
                    }
                }}
            />
        </label>
    );
}
