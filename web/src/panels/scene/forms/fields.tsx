// The fields of a command: required and important ones first, the others below.
import type { VNode } from "preact";
import type { Argument, Command } from "../../../protocol";
import type { Values } from "../../../script/values";
import { ArgumentField } from "./argument_field";
import type { FieldContext } from "./field";

const kMaxAtOnce = 7;

/** The arguments that are shown at once: required ones, those with a value, and the first of the others. */
export function initialFields({ arguments: all }: Command, given: Values): Argument[] {
    const wanted = all.filter((argument) => argument.required || argument.name in given);
    const rest = all.filter((argument) => !wanted.includes(argument)).slice(0, Math.max(kMaxAtOnce - wanted.length, 0));
    return all.filter((argument) => wanted.includes(argument) || rest.includes(argument));
}

interface Props {
    command: Command;
    first: readonly Argument[];
    context: FieldContext;
}

export function Fields({ command, first, context }: Props): VNode {
    const rest = command.arguments.filter((argument) => !first.includes(argument));
    const field = (argument: Argument) => <ArgumentField key={`${command.name}.${argument.name}`} argument={argument} context={context} />;
    return (
        <>
            {first.map(field)}
            {rest.length > 0 && (
                <details class="all-options">
                    <summary>{`${rest.length} more options`}</summary>
                    {rest.map(field)}
                </details>
            )}
        </>
    );
}
