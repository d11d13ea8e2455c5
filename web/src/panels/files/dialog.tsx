// Dialogs with a result that the caller awaits.
import { signal } from "@preact/signals-core";
import type { ComponentChildren, VNode } from "preact";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { EngineError } from "../../app";
import { useValue } from "../../use";

type End<T> = (answer: T | null) => void;

interface OpenDialog {
    number: number;
    draw(): VNode;
}

const kOpenDialogs = signal<readonly OpenDialog[]>([]);
let kLast = 0;

/** Shows a dialog and waits for its answer: null if the user cancels it. */
export function openDialog<T>(draw: (end: End<T>) => VNode): Promise<T | null> {
    return new Promise((resolve) => {
        const number = ++kLast;
        const end = (answer: T | null) => {
            kOpenDialogs.value = kOpenDialogs.peek().filter((one) => one.number !== number);
            resolve(answer);
        };
        kOpenDialogs.value = [...kOpenDialogs.peek(), { number, draw: () => draw(end) }];
    });
}

/** Container of dialogs; once in the page. */
export function Dialogs(): VNode {
    return (
        <>
            {useValue(kOpenDialogs).map((one) => (
                <DialogContent key={one.number} draw={one.draw} />
            ))}
        </>
    );
}

function DialogContent({ draw }: { draw(): VNode }): VNode {
    return draw();
}

interface DialogProps {
    title: string;
    wide?: boolean;
    close(): void; // Esc
    accept?(): void; // Enter, and the submit button
    children: ComponentChildren;
    buttons: ComponentChildren;
}

/** A modal dialog, open as long as it is drawn. */
export function Dialog({ title, wide, close, accept, children, buttons }: DialogProps): VNode {
    const element = useRef<HTMLDialogElement>(null);
    useLayoutEffect(() => {
        const dialog = element.current;
        dialog?.showModal();
        return () => {
            dialog?.close(); // returns the focus to the previous element
            const below = [...document.querySelectorAll("dialog[open]")].at(-1);
            if (below && !below.contains(document.activeElement)) {
                below.querySelector<HTMLElement>("[autofocus]")?.focus(); // otherwise it cannot receive the focus: it is disabled during work
            }
        };
    }, []);
    return (
        <dialog
            class={wide ? "dialog file-dialog wide" : "dialog file-dialog"}
            ref={element}
            aria-label={title}
            onCancel={(event) => {
                event.preventDefault();
                close();
            }}
        >
            <form
                onSubmit={(event) => {
                    event.preventDefault();
                    accept?.();
                }}
                onKeyDown={(event) => {
                    if (event.key === "Enter" && event.target instanceof HTMLSelectElement) {
                        event.preventDefault(); // only lists do not submit the form by themselves
                        accept?.();
                    }
                }}
            >
                <h2>{title}</h2>
                <div class="dialog-body">{children}</div>
                <div class="dialog-buttons">{buttons}</div>
            </form>
        </dialog>
    );
}

type Answers<T> = readonly (readonly [T, string])[];

/** A question with one button for each answer; Enter selects the first one, or none if `careful`. */
export function choose<T extends string>(title: string, text: string, answers: Answers<T>, careful = false): Promise<T | null> {
    return openDialog<T>((end) => (
        <Dialog
            title={title}
            close={() => end(null)}
            buttons={
                <>
                    {answers.map(([answer, label], at) => (
                        <button key={answer} type="button" class={at === 0 ? "primary" : ""} autofocus={at === 0 && !careful} onClick={() => end(answer)}>
                            {label}
                        </button>
                    ))}
                    <button type="button" autofocus={careful} onClick={() => end(null)}>
                        Cancel
                    </button>
                </>
            }
        >
            <p>{text}</p>
        </Dialog>
    ));
}

/** A question about an irreversible action: Enter alone does not confirm. */
export async function confirm(title: string, text: string, yes: string): Promise<boolean> {
    return (await choose(title, text, [["yes", yes]], true)) === "yes";
}

/** Shows text, such as the output of a program. */
export function showText(title: string, text: string): Promise<null> {
    return openDialog<null>((end) => (
        <Dialog
            title={title}
            wide
            close={() => end(null)}
            buttons={
                <button type="button" autofocus onClick={() => end(null)}>
                    Close
                </button>
            }
        >
            <pre class="printed" tabIndex={0} aria-label={title}>
                {text}
            </pre>
        </Dialog>
    ));
}

/** State of a dialog: one task at a time, and its error. */
export function useWork(): { busy: boolean; errorText: string; work(task: () => Promise<void>): Promise<void> } {
    const [busy, setBusy] = useState(false);
    const [errorText, setErrorText] = useState("");
    const work = async (task: () => Promise<void>) => {
        setBusy(true);
        setErrorText("");
        try {
            await task();
        } catch (error) {
            const stopped = error instanceof EngineError && error.kind === "cancelled";
            setErrorText(stopped ? "Stopped." : (error as Error).message);
        } finally {
            setBusy(false);
        }
    };
    return { busy, errorText, work };
}

export function ErrorText({ text }: { text: string }): VNode {
    return (
        <p class="error" role="alert">
            {text}
        </p>
    );
}
