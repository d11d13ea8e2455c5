// Properties and attributes that the fields of arguments have in common.
import type { Argument, Kind } from "../../../protocol";
import type { NumberLimits } from "../../../script/arithmetic";
import type { Values } from "../../../script/values";

export interface FieldContext {
    values: Values;
    /** `done`: the user has finished the change; before that the value is only previewed. */
    set(name: string, words: readonly string[], done: boolean): void;
    names(kinds: readonly Kind[]): string[]; // names of the existing objects of these kinds
    usual?(name: string): number | undefined; // centre of the range of sliders; the default of the argument if undefined
    focus?(name: string | null): void;
    files?(): string[]; // files of the folder
    selected?(): Promise<string | null>; // nodes selected in the 3D view, as a selection expression
}

export interface ArgumentProps {
    argument: Argument;
    context: FieldContext;
}

/** Properties of the widget within a row: `id` is the id of its label and, with "-help", of its help. */
export type FieldProps = ArgumentProps & { id: string };

export function isGiven({ argument, context }: ArgumentProps): boolean {
    return (context.values[argument.name] ?? []).length > 0;
}

/** Attributes common to all fields; a value that is not set looks like a default. */
export function inputAttributes(props: FieldProps): Record<string, unknown> {
    const { argument, id } = props;
    return {
        "aria-describedby": `${id}-help`,
        "aria-required": argument.required || undefined,
        class: isGiven(props) ? undefined : "is-default",
    };
}

export function limitsOf({ low, high, type }: Argument): NumberLimits {
    return { low, high, whole: type === "whole" };
}

/** Step that changes a number by about a tenth of its size. */
export function stepOf({ type }: Argument, value: number): number {
    const size = Math.abs(value);
    return type === "whole" ? 1 : size > 0 ? 10 ** Math.floor(Math.log10(size) - 0.3) : 0.1;
}
