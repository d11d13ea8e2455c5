// A point, or other numbers that belong together, as a field for each.
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import { spoken } from "../../../script/commands";
import { wordOf } from "../../../script/values";
import { fieldProps, fits, type Inner, stepOf } from "./argument_field";

const kNames = ["X", "Y", "Z"];

/** The numbers of a tuple as one word; null where so many are not allowed. Of a point what is not said is 0. */
export function tupleWord(parts: readonly string[], sizes: readonly number[]): string | null {
    const said = parts.findLastIndex((part) => part.trim() !== "") + 1;
    const isPoint = sizes.length === 1 && said > 0;
    const count = isPoint ? sizes[0] : said;
    const given = parts.slice(0, count).map((part) => part.trim() || (isPoint ? "0" : ""));
    const whole = given.every((part) => part !== "" && Number.isFinite(Number(part)));
    return whole && sizes.includes(count) ? given.join(",") : null;
}

export function TupleField(props: Inner): VNode {
    const { argument, context, id } = props;
    const sizes = argument.sizes ?? [3];
    const most = Math.max(...sizes);
    const word = wordOf(argument, context.values);
    const [draft, setDraft] = useState<readonly string[] | null>(null); // while some are still to come
    const parts = draft ?? word.split(",");
    const set = (at: number, text: string, done: boolean) => {
        const next = Array.from({ length: most }, (_, i) => (i === at ? text : (parts[i] ?? "")));
        const empty = next.every((part) => part.trim() === "");
        const now = empty ? null : tupleWord(next, sizes);
        const good = now !== null && now.split(",").every((part) => fits(argument, Number(part)));
        setDraft(empty || good ? null : next);
        if (empty || good) {
            context.set(argument.name, now === null ? [] : [now], done);
        }
    };
    return (
        <div class="wide tuple" role="group" aria-labelledby={`${id}-label`}>
            {Array.from({ length: most }, (_, at) => (
                <input
                    {...fieldProps(props)}
                    key={at}
                    type="number"
                    aria-invalid={draft !== null || undefined}
                    aria-label={most <= 3 ? kNames[at] : `${spoken(argument.name)} ${at + 1}`}
                    placeholder={kNames[at] ?? String(at + 1)}
                    value={parts[at] ?? ""}
                    step={stepOf(argument, Number(parts[at] ?? 0))}
                    onInput={(event) => set(at, event.currentTarget.value, false)}
                    onChange={(event) => set(at, event.currentTarget.value, true)}
                />
            ))}
        </div>
    );
}
