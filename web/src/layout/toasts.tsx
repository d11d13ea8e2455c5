// Messages, which disappear automatically unless they are errors. They never receive the focus.
import type { VNode } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Message, Store } from "../app";
import { useValue } from "../use";

const kMinSeconds = 6;
const kSecondsALetter = 0.06;
const kMaxShown = 3; // of errors, and of others

// Messages are equal if their texts are, but each has its own identity.
const kNumbers = new WeakMap<Message, number>();
let kLast = 0;

function numberOf(message: Message): number {
    const number = kNumbers.get(message) ?? ++kLast;
    kNumbers.set(message, number);
    return number;
}

function alike(a: Message, b: Message): boolean {
    return a.level === b.level && a.text === b.text;
}

interface ToastProps {
    message: Message;
    times: number; // number of repetitions
    close(): void;
}

function Toast({ message, times, close }: ToastProps): VNode {
    const [held, setHeld] = useState(false); // being read, or about to be closed
    useEffect(() => {
        if (message.level === "error" || held) {
            return undefined;
        }
        const seconds = Math.max(kMinSeconds, message.text.length * kSecondsALetter);
        const timer = setTimeout(close, seconds * 1000);
        return () => clearTimeout(timer);
    }, [message, held]);
    return (
        <li
            class={`toast ${message.level}`}
            onPointerEnter={() => setHeld(true)}
            onPointerLeave={() => setHeld(false)}
            onFocusIn={() => setHeld(true)}
            onFocusOut={() => setHeld(false)}
        >
            <span>{times > 1 ? `${message.text} (${times} times)` : message.text}</span>
            <button type="button" class="icon" aria-label="Close this message" onClick={close}>
                ×
            </button>
        </li>
    );
}

export function Toasts({ store }: { store: Store }): VNode {
    const messages = useValue(store.messages);
    const [closed, setClosed] = useState<ReadonlySet<Message>>(new Set());
    const lists = useRef<HTMLDivElement>(null);
    const close = (message: Message) => {
        const hadFocus = lists.current?.contains(document.activeElement);
        setClosed((before) => new Set([...before, ...messages.filter((one) => alike(one, message))]));
        if (hadFocus) {
            document.querySelector<HTMLElement>(".picture-canvas canvas")?.focus(); // otherwise no element would have the focus
        }
    };
    const open = messages.filter((message) => !closed.has(message));
    const draw = (shown: readonly Message[]) => {
        const newest = shown.filter((message, at) => !shown.slice(at + 1).some((later) => alike(later, message)));
        return (
            <ul>
                {newest.slice(-kMaxShown).map((message) => (
                    <Toast key={numberOf(message)} message={message} times={shown.filter((one) => alike(one, message)).length} close={() => close(message)} />
                ))}
            </ul>
        );
    };
    return (
        <div class="toasts" ref={lists} role="region" aria-label="Messages">
            <div role="alert">{draw(open.filter(({ level }) => level === "error"))}</div>
            <div role="status">{draw(open.filter(({ level }) => level !== "error"))}</div>
        </div>
    );
}
