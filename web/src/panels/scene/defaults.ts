// Initial values of forms that the user has set: "grow.kill_radius" is 0.3, until the page is closed.
import { type Signal, signal } from "@preact/signals-core";
import type { Values } from "../../script/values";

/** Texts as typed, by "COMMAND.ARGUMENT". */
export const kDefaults: Signal<ReadonlyMap<string, string>> = signal(new Map());

/** Null restores the default of the command. */
export function setDefault(key: string, value: string | null): void {
    const next = new Map(kDefaults.peek());
    if (value === null) {
        next.delete(key);
    } else {
        next.set(key, value);
    }
    kDefaults.value = next;
}

/** The values set for a command, by argument. */
export function defaultsOf(command: string): Values {
    const begin = `${command}.`;
    const mine = [...kDefaults.value].filter(([key]) => key.startsWith(begin));
    return Object.fromEntries(mine.map(([key, value]) => [key.slice(begin.length), [value]]));
}
