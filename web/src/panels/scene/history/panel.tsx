// List of done and undone changes: a click goes to the state after one.
import type { VNode } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { App } from "../../../app";
import { scrollWithin } from "../../../scroll";
import { useValue } from "../../../use";
import { type Change, changesOf } from "./model";

function go(app: App, { steps }: Change): void {
    if (steps !== 0) {
        app.engine.request(steps < 0 ? "undo" : "redo", { count: Math.abs(steps) }).catch((error: Error) => app.store.notify(error.message, "error"));
    }
}

export function HistoryPanel({ app }: { app: App }): VNode {
    const state = useValue(app.store.state);
    const locked = useValue(app.store.connection) !== "ready";
    const list = useRef<HTMLOListElement>(null);
    const changes = changesOf(state);
    const now = changes.findIndex(({ when }) => when === "now");
    useEffect(() => {
        const box = list.current;
        const button = box?.children[now]?.firstElementChild;
        if (box && button instanceof HTMLElement && !box.contains(document.activeElement)) {
            const room = box.clientHeight / 2;
            scrollWithin(box, button.offsetTop - room, button.offsetTop + room);
        }
    }, [now, changes.length]);
    const key = (event: KeyboardEvent) => {
        const buttons = [...(list.current?.querySelectorAll("button") ?? [])];
        const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
        const to: Record<string, number> = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: buttons.length - 1 };
        const button = at >= 0 ? buttons[to[event.key]] : undefined;
        if (button) {
            button.focus();
            event.preventDefault();
        }
    };
    return (
        <ol class="history" ref={list} aria-label="Changes of the scene" onKeyDown={key}>
            {changes.map((change, at) => (
                <li key={at}>
                    <button
                        type="button"
                        class={`history-${change.when}`}
                        disabled={locked}
                        tabIndex={at === now ? 0 : -1}
                        aria-current={change.when === "now" ? "step" : undefined}
                        title={change.when === "undone" ? `Redo up to: ${change.name}` : `Go back to the state after: ${change.name}`}
                        onClick={() => go(app, change)}
                    >
                        {change.name}
                    </button>
                </li>
            ))}
        </ol>
    );
}
