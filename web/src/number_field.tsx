// Number fields: arithmetic is computed, and invalid input is refused with a message.
import type { TargetedEvent, TargetedKeyboardEvent, VNode } from "preact";
import { useRef, useState } from "preact/hooks";
import { type NumberLimits, readNumber } from "./script/arithmetic";

export interface NumberOptions extends NumberLimits {
    value: number | null; // null: no value
    shown?: string; // text while the field is not edited; default is the value
    step?: number; // of the arrow keys
    /** Accepts a number; `done` after Enter or when the field loses the focus. */
    take(value: number, done: boolean): void;
    /** Handles an empty field; if undefined, an empty field is refused. */
    clear?(): void;
}

/** Attributes of a number input, and the reason why the last text was refused; empty if it was accepted. */
export function useNumber({ value, shown = String(value ?? ""), step = 1, take, clear, ...limits }: NumberOptions) {
    const [draft, setDraft] = useState<string | null>(null); // current text
    const [errorText, setErrorText] = useState("");
    const before = useRef({ value, shown, isKept: true }); // value that a refused text leaves unchanged
    const read = draft !== null && draft.trim() !== "" ? readNumber(draft, limits) : null;

    const refuse = (why: string) => {
        const { value: old, shown: text, isKept } = before.current;
        setErrorText(`${why} The field stays ${old === null ? "empty" : text}.`);
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
        "aria-invalid": (read && "errorText" in read) || undefined,
        onInput: (event: TargetedEvent<HTMLInputElement>) => {
            const text = event.currentTarget.value;
            if (draft === null) {
                before.current = { value, shown, isKept: true };
            }
            setDraft(text);
            setErrorText("");
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
                refuse(text.trim() === "" ? "Enter a number." : now.errorText);
            }
        },
        onBlur: () => setDraft(null),
        onKeyDown: (event: TargetedKeyboardEvent<HTMLInputElement>) => {
            const direction = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
            const now = readNumber(event.currentTarget.value);
            if (direction === 0 || !("value" in now) || event.altKey || event.ctrlKey || event.metaKey) {
                return;
            }
            event.preventDefault();
            const { low = -Infinity, high = Infinity } = limits;
            setDraft(null);
            setErrorText("");
            take(Number(Math.min(Math.max(now.value + direction * step, low), high).toPrecision(12)), true);
        },
    };
    return { field, errorText };
}

/** Shows why a field did not accept its text. */
export function FieldError({ text }: { text: string }): VNode | null {
    return text === "" ? null : (
        <p class="field-error" role="alert">
            {text}
        </p>
    );
}
