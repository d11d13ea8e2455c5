// Numbers in the rows of the timeline.
import type { VNode } from "preact";
import { FieldError, useNumber } from "../../../number_field";

interface AmountProps {
    label: string;
    value: number;
    low: number;
    high: number;
    step: number;
    title?: string;
    set(value: number): void;
}

/** A number of a film, applied when it is complete. */
export function Amount({ label, value, low, high, step, title, set }: AmountProps): VNode {
    const { field, errorText } = useNumber({ value, low, high, step, take: (number, done) => done && set(number) });
    return (
        <>
            <label title={title}>
                <span>{label}</span>
                <input class="amount" {...field} />
            </label>
            <FieldError text={errorText} />
        </>
    );
}
