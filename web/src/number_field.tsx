// Fields for numbers: arithmetic is computed, and what is no number is refused in a sentence.
import type { TargetedEvent, TargetedKeyboardEvent, VNode } from "preact";
import { useRef, useState } from "preact/hooks";
import { type NumberLimits, readNumber } from "./script/arithmetic";

export interface NumberOptions extends NumberLimits {
    value: number | null; // null: none
    shown?: string; // while the field is not edited; the value where not given
    step?: number; // of the arrow keys
    /** Takes a number; `done` once Enter was pressed or the field was left. */
    take(value: number, done: boolean): void;
    /** What an empty field means; where not given an empty field is refused. */
    clear?(): void;
}

/** The attributes of an input for a number, and why what was typed last was refused; empty where it was not. */
export function useNumber({ value, shown = String(value ?? ""), step = 1, take, clear, ...limits }: NumberOptions) {
    const [draft, setDraft] = useState<string | null>(null); // what is typed now
    const [trouble, setTrouble] = useState("");
    const before = useRef({ value, shown, isKept: true }); // what a refused text leaves in place
    const read = draft !== null && draft.trim() !== "" ? readNumber(draft, limits) : null;

    const refuse = (why: string) => {
        const { value: old, shown: text, isKept } = before.current;
        setTrouble(`${why} The field stays ${old === null ? "empty" : text}.`);
        if (!isKept && old !== null) {
            take(old, true);
        } else if (!isKept) {
            clear?.();
        }
    };
    const field = {
        type: "text" as const,
        inputMode: "decimal" as const,
        autocomplete: "off",
        spellcheck: false,
        value: draft ?? shown,
        "aria-invalid": (read && "trouble" in read) || undefined,
        onInput: (event: TargetedEvent<HTMLInputElement>) => {
            const text = event.currentTarget.value;
            if (draft === null) {
                before.current = { value, shown, isKept: true };
            }
            setDraft(text);
            setTrouble("");
            const now = readNumber(text, limits);
            if ("value" in now) {
                before.current.isKept = false;
                take(now.value, false);
            }
        },
        onChange: (event: TargetedEvent<HTMLInputElement>) => {
            const text = event.currentTarget.value;
            setDraft(null);
            const now = readNumber(text, limits);
            if ("value" in now) {
                take(now.value, true);
            } else if (text.trim() === "" && clear) {
                clear();
            } else {
                refuse(text.trim() === "" ? "This takes a number." : now.trouble);
            }
        },
        onBlur: () => setDraft(null),
        onKeyDown: (event: TargetedKeyboardEvent<HTMLInputElement>) => {
            const way = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
            const now = readNumber(event.currentTarget.value);
            if (way === 0 || !("value" in now) || event.altKey || event.ctrlKey || event.metaKey) {
                return;
            }
            event.preventDefault();
            const { low = -Infinity, high = Infinity } = limits;
            setDraft(null);
            setTrouble("");
            take(Number(Math.min(Math.max(now.value + way * step, low), high).toPrecision(12)), true);
        },
    };
    return { field, trouble };
}

/** Says why a field did not take what was typed. */
export function FieldTrouble({ text }: { text: string }): VNode | null {
    return text === "" ? null : <p class="field-trouble" role="alert">{text}</p>;
}
