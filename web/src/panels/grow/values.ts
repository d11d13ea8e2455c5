// Commands by name, and numbers of a form's values.
import type { Command } from "../../protocol";
import { type Values, wordOf } from "../../script/values";

export function commandNamed(schema: readonly Command[], name: string): Command | undefined {
    return schema.find((command) => command.name === name);
}

/** The number given for an argument, else its default; NaN where there is none. */
export function numberOf(command: Command, values: Values, name: string): number {
    const argument = command.arguments.find((one) => one.name === name);
    return argument ? Number(wordOf(argument, values)) : NaN;
}
