// The context menu of an object, at the pointer or next to its row.
import type { VNode } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import type { App } from "../../../app";
import type { ObjectName } from "../../../protocol";
import { duplicate, isHidden, isVisible, remove, rename, showLine, toggleHidden } from "./actions";

interface Item {
    label: string;
    keys: string;
    run(): void;
}

function itemsOf(app: App, object: ObjectName): Item[] {
    const looks: Item[] = [
        { label: "Frame it", keys: "", run: () => app.view.frame([object]) },
        { label: isHidden(app, object) ? "Show" : "Hide", keys: "H", run: () => toggleHidden(app, object) },
    ];
    return [
        ...(isVisible(object) ? looks : []),
        { label: "Rename…", keys: "F2", run: () => void rename(app, object) },
        { label: "Duplicate", keys: "Shift+D", run: () => void duplicate(app, object) },
        { label: "Show its line", keys: "", run: () => showLine(app, object) },
        { label: "Delete", keys: "Delete", run: () => void remove(app, object) },
    ];
}

interface Props {
    app: App;
    object: ObjectName;
    at: { x: number; y: number }; // [px] in the window
    close(): void;
}

export function ContextMenu({ app, object, at, close }: Props): VNode {
    const menu = useRef<HTMLDivElement>(null);
    const items = itemsOf(app, object);
    useLayoutEffect(() => {
        const element = menu.current;
        if (!element) {
            return;
        }
        const { width, height } = element.getBoundingClientRect();
        element.style.left = `${Math.max(Math.min(at.x, innerWidth - width - 4), 4)}px`;
        element.style.top = `${Math.max(Math.min(at.y, innerHeight - height - 4), 4)}px`;
        element.querySelector<HTMLElement>("[role=menuitem]")?.focus();
    }, []);
    const key = (event: KeyboardEvent) => {
        const buttons = [...(menu.current?.querySelectorAll<HTMLElement>("[role=menuitem]") ?? [])];
        const now = buttons.indexOf(document.activeElement as HTMLElement);
        const to: Record<string, number> = { ArrowDown: now + 1, ArrowUp: now - 1, Home: 0, End: -1 };
        if (event.key in to) {
            buttons.at(to[event.key] % buttons.length)?.focus();
        } else if (event.key === "Escape" || event.key === "Tab") {
            close();
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation();
    };
    const left = (event: FocusEvent) => {
        if (!(event.relatedTarget instanceof Node && menu.current?.contains(event.relatedTarget))) {
            close();
        }
    };
    return (
        <div ref={menu} class="context-menu" role="menu" aria-label={`${object.kind} ${object.name}`} onKeyDown={key} onFocusOut={left}>
            {items.map(({ label, keys, run }) => (
                <button
                    key={label}
                    type="button"
                    role="menuitem"
                    tabIndex={-1}
                    onClick={() => {
                        close();
                        run();
                    }}
                >
                    <span>{label}</span>
                    <span class="hint">{keys}</span>
                </button>
            ))}
        </div>
    );
}
