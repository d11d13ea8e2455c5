// A point or another tuple of numbers, with a field for each number.
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import { FieldError, useNumber } from "../../../number_field";
import { displayName } from "../../../script/commands";
import { wordOf } from "../../../script/values";
import { type FieldProps, inputAttributes, limitsOf, stepOf } from "./field";

const kNames = ["X", "Y", "Z"];

/** The numbers of a tuple as one word; null if their number is not allowed. Missing coordinates of a point are 0. */
export function tupleWord(parts: readonly string[], sizes: readonly number[]): string | null {
    const filledCount = parts.findLastIndex((part) => part.trim() !== "") + 1;
    const isPoint = sizes.length === 1 && filledCount > 0;
    const count = isPoint ? sizes[0] : filledCount;
    const given = parts.slice(0, count).map((part) => part.trim() || (isPoint ? "0" : ""));
    const whole = given.every((part) => part !== "" && Number.isFinite(Number(part)));
    return whole && sizes.includes(count) ? given.join(",") : null;
}

interface PartProps {
    field: FieldProps;
    label: string;
    placeholder: string;
    text: string;
    isInvalid: boolean;
    set(text: string, done: boolean): void;
}

function PartField({ field: whole, label, placeholder, text, isInvalid, set }: PartProps): VNode {
    const { argument } = whole;
    const { field, errorText } = useNumber({
        value: text === "" ? null : Number(text),
        shown: text,
        ...limitsOf(argument),
        step: stepOf(argument, Number(text)),
        take: (value, done) => set(String(value), done),
        clear: () => set("", true),
    });
    return (
        <>
            <input {...inputAttributes(whole)} {...field} aria-invalid={isInvalid || field["aria-invalid"]} aria-label={label} placeholder={placeholder} />
            <FieldError text={errorText} />
        </>
    );
}

export function TupleField(props: FieldProps): VNode {
    const { argument, context, id } = props;
    const sizes = argument.sizes ?? [3];
    const most = Math.max(...sizes);
    const word = wordOf(argument, context.values);
    const [draft, setDraft] = useState<readonly string[] | null>(null); // set while some numbers are missing
    const parts = draft ?? word.split(",");
    const set = (at: number, text: string, done: boolean) => {
        const next = Array.from({ length: most }, (_, i) => (i === at ? text : (parts[i] ?? "")));
        const empty = next.every((part) => part.trim() === "");
        const now = empty ? null : tupleWord(next, sizes);
        const good = empty || now !== null;
        setDraft(good ? null : next);
        if (good) {
            context.set(argument.name, now === null ? [] : [now], done);
        }
    };
    return (
        <div class="wide tuple" role="group" aria-labelledby={`${id}-label`}>
            {Array.from({ length: most }, (_, at) => (
                <PartField
                    key={at}
                    field={props}
                    label={most <= 3 ? kNames[at] : `${displayName(argument.name)} ${at + 1}`}
                    placeholder={kNames[at] ?? String(at + 1)}
                    text={parts[at] ?? ""}
                    isInvalid={draft !== null}
                    set={(text, done) => set(at, text, done)}
                />
            ))}
        </div>
    );
}
