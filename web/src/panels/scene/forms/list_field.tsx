// Fields for arguments that may be given several times.
import type { VNode } from "preact";
import { displayName } from "../../../script/commands";
import type { FieldProps } from "./field";

/** A text field for each value, and an empty one. */
export function ListField({ argument, context, id }: FieldProps): VNode {
    const given = context.values[argument.name] ?? [];
    const words = given.length === 0 && argument.default ? [argument.default] : given;
    const put = (at: number, word: string) => context.set(argument.name, words.toSpliced(at, 1, word), true);
    const example = argument.type === "section" ? "profile@0.5" : argument.sizes ? Array(argument.sizes[0]).fill("0").join(",") : "";
    return (
        <div class="wide list" role="group" aria-labelledby={`${id}-label`}>
            {[...words, ""].map((word, at) => (
                <input
                    key={`${at}:${word}`}
                    type="text"
                    spellcheck={false}
                    autocomplete="off"
                    class={given.length === 0 ? "is-default" : undefined}
                    aria-label={`${displayName(argument.name)} ${at + 1}`}
                    aria-describedby={`${id}-help`}
                    placeholder={at < words.length ? undefined : at === 0 ? example : "one more"}
                    value={word}
                    onChange={(event) => put(at, event.currentTarget.value.trim())}
                />
            ))}
        </div>
    );
}

/** An ordered list of objects: each can be removed, and one can be added. */
export function PickList({ argument, context, id, names }: FieldProps & { names: readonly string[] }): VNode {
    const words = context.values[argument.name] ?? [];
    const set = (next: readonly string[]) => context.set(argument.name, next, true);
    const rest = names.filter((name) => !words.includes(name));
    return (
        <div class="wide list" role="group" aria-labelledby={`${id}-label`}>
            {words.map((word, at) => (
                <span key={word} class="picked">
                    <span>{word}</span>
                    <button
                        type="button"
                        class="icon"
                        aria-label={`Move ${word} up`}
                        disabled={at === 0}
                        onClick={() => set(words.with(at, words[at - 1]).with(at - 1, word))}
                    >
                        ↑
                    </button>
                    <button type="button" class="icon" aria-label={`Remove ${word}`} onClick={() => set(words.toSpliced(at, 1))}>
                        ×
                    </button>
                </span>
            ))}
            <select
                aria-label={`Add to ${displayName(argument.name)}`}
                aria-describedby={`${id}-help`}
                disabled={rest.length === 0}
                value=""
                onChange={(event) => set([...words, event.currentTarget.value])}
            >
                <option value="">{rest.length === 0 ? "no other object to add" : "add…"}</option>
                {rest.map((name) => (
                    <option key={name} value={name}>
                        {name}
                    </option>
                ))}
            </select>
        </div>
    );
}
