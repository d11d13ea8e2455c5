// Commands by name, and numbers in the values of a form.
import type { Command } from "../../protocol";
import { type Values, wordOf } from "../../script/values";

export function commandNamed(schema: readonly Command[], name: string): Command | undefined {
    return schema.find((command) => command.name === name);
}

/** The number of an argument, or its default; NaN if there is no default. */
export function numberOf(command: Command, values: Values, name: string): number {
    const argument = command.arguments.find((one) => one.name === name);
    return argument ? Number(wordOf(argument, values)) : NaN;
}
