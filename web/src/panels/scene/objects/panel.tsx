// The objects of the scene as a tree, for pointer, keyboard and screen readers.
import { computed, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { App } from "../../../app";
import type { ObjectName } from "../../../protocol";
import { scrollWithin } from "../../../scroll";
import { useValue } from "../../../use";
import { duplicate, isHidden, isVisible, remove, rename, select, toggleHidden } from "./actions";
import { ContextMenu } from "./context_menu";
import { found, idOf, type Row, rowsOf } from "./model";

const kClosed = signal<ReadonlySet<string>>(new Set());
const kTyping = 700; // [ms] within which letters belong to one name

function setOpen(id: string, open: boolean): void {
    const closed = new Set(kClosed.peek());
    if (open) {
        closed.delete(id);
    } else {
        closed.add(id);
    }
    kClosed.value = closed;
}

interface RowProps {
    app: App;
    row: Row;
    active: boolean;
    selected: boolean;
    hidden: boolean;
    focus(): void;
    menu(x: number, y: number): void;
}

function TreeRow({ app, row, active, selected, hidden, focus, menu }: RowProps): VNode {
    const { object, open, id } = row;
    const choose = () => {
        focus();
        if (object) {
            select(app, object);
        } else {
            setOpen(id, !open);
        }
    };
    return (
        <div
            class={`tree-row${hidden ? " hidden-object" : ""}${object ? "" : " tree-group"}`}
            role="treeitem"
            id={`row-${id}`}
            aria-level={row.level}
            aria-posinset={row.position}
            aria-setsize={row.size}
            aria-expanded={open ?? undefined}
            aria-selected={object ? selected : undefined}
            aria-labelledby={`label-${id} detail-${id}`}
            tabIndex={active ? 0 : -1}
            style={{ paddingLeft: `${(row.level - 1) * 14 + 2}px` }}
            onClick={choose}
            onDblClick={() => object && app.view.frame([object])}
            onContextMenu={(event) => {
                event.preventDefault();
                if (object) {
                    choose();
                    menu(event.clientX, event.clientY);
                }
            }}
        >
            <span
                class={open === null ? "twist" : open ? "twist open" : "twist closed"}
                aria-hidden="true"
                onClick={(event) => {
                    if (open !== null) {
                        event.stopPropagation();
                        setOpen(id, !open);
                    }
                }}
            />
            <span class="tree-label" id={`label-${id}`}>
                {row.label}
            </span>{" "}
            <span class="hint" id={`detail-${id}`}>
                {hidden ? "hidden" : row.detail}
            </span>
            {object && (
                <>
                    {isVisible(object) && (
                        <button
                            type="button"
                            class="icon quiet"
                            tabIndex={-1}
                            aria-label={`${hidden ? "Show" : "Hide"} ${row.label}`}
                            title={hidden ? "Show (H)" : "Hide (H)"}
                            onClick={(event) => {
                                event.stopPropagation();
                                toggleHidden(app, object);
                            }}
                        >
                            <Eye open={!hidden} />
                        </button>
                    )}
                    <button
                        type="button"
                        class="icon quiet"
                        tabIndex={-1}
                        aria-haspopup="menu"
                        aria-label={`More about ${row.label}`}
                        onClick={(event) => {
                            event.stopPropagation();
                            focus();
                            const box = event.currentTarget.getBoundingClientRect();
                            menu(box.left, box.bottom);
                        }}
                    >
                        ⋯
                    </button>
                </>
            )}
        </div>
    );
}

function Eye({ open }: { open: boolean }): VNode {
    return (
        <svg width="16" height="16" viewBox="0 0 16 16" fill="none" stroke="currentColor" stroke-width="1.4" aria-hidden="true">
            <path d="M1 8c2-3.4 4.4-5 7-5s5 1.6 7 5c-2 3.4-4.4 5-7 5S3 11.4 1 8z" />
            {open ? <circle cx="8" cy="8" r="2.2" fill="currentColor" /> : <path d="M2 14 14 2" />}
        </svg>
    );
}

interface Menu {
    object: ObjectName;
    at: { x: number; y: number };
}

/** Handles a key for the focused row. Returns whether the tree used the key. */
function objectKey(app: App, event: KeyboardEvent, object: ObjectName): boolean {
    const run: Record<string, () => void> = {
        Enter: () => select(app, object),
        " ": () => select(app, object),
        F2: () => void rename(app, object),
        Delete: () => void remove(app, object),
        D: () => void duplicate(app, object),
        h: () => toggleHidden(app, object),
    };
    const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
    run[event.key]?.call(null);
    return plain && event.key in run;
}

function useTree(app: App, rows: readonly Row[]) {
    const tree = useRef<HTMLDivElement>(null);
    const [active, setActive] = useState("");
    const typed = useRef({ text: "", time: 0 });
    const last = useRef(0); // index of the active row, in case it is removed
    const known = rows.findIndex(({ id }) => id === active);
    const now = known >= 0 ? known : Math.min(last.current, rows.length - 1);
    last.current = now;
    const hadFocus = useRef(false);
    useEffect(() => {
        if (known < 0 && hadFocus.current && document.activeElement === document.body) {
            go(now); // its row was removed together with its object
        }
    });
    const go = (at: number) => {
        const row = rows[Math.min(Math.max(at, 0), rows.length - 1)];
        if (row) {
            setActive(row.id);
            document.getElementById(`row-${row.id}`)?.focus();
        }
    };
    const sideways = (row: Row, right: boolean) => {
        if (right && row.open === false) {
            setOpen(row.id, true);
        } else if (right && row.open) {
            go(now + 1);
        } else if (!right && row.open) {
            setOpen(row.id, false);
        } else if (!right) {
            go(rows.findIndex(({ id }) => id === row.parent));
        }
    };
    const search = (letter: string) => {
        const within = performance.now() - typed.current.time < kTyping;
        typed.current = { text: (within ? typed.current.text : "") + letter, time: performance.now() };
        const { text } = typed.current;
        const at = found(rows, text.length > 1 ? now - 1 : now, text);
        if (at >= 0) {
            go(at);
        }
    };
    const isTyping = () => typed.current.text !== "" && performance.now() - typed.current.time < kTyping;
    const key = (event: KeyboardEvent, menu: (object: ObjectName) => void): boolean => {
        const row = rows[now];
        const moves: Record<string, number> = { ArrowDown: now + 1, ArrowUp: now - 1, Home: 0, End: rows.length - 1 };
        const isLetter = /^[A-Za-z0-9_]$/.test(event.key);
        if (!row || event.ctrlKey || event.metaKey) {
            return false;
        }
        if (event.altKey) {
            return false; // Alt+H and others belong to the page
        }
        if (event.key in moves) {
            go(moves[event.key]);
        } else if (event.key === "ArrowRight" || event.key === "ArrowLeft") {
            sideways(row, event.key === "ArrowRight");
        } else if (row.object && (event.key === "ContextMenu" || (event.key === "F10" && event.shiftKey))) {
            menu(row.object);
        } else if (row.object && !(isLetter && isTyping()) && objectKey(app, event, row.object)) {
            return true;
        } else if (!row.object && (event.key === "Enter" || event.key === " ")) {
            setOpen(row.id, !row.open);
        } else if (isLetter) {
            search(event.key);
        } else {
            return false;
        }
        return true;
    };
    return { tree, now, setActive, key, hadFocus };
}

export function ObjectsPanel({ app }: { app: App }): VNode {
    const rows = useValue(useMemo(() => computed(() => rowsOf(app.store.state.value, app.store.schema.value, kClosed.value)), [app]));
    const { object: chosen } = useValue(app.store.selection);
    useValue(app.store.hidden);
    const [menu, setMenu] = useState<Menu | null>(null);
    const { tree, now, setActive, key, hadFocus } = useTree(app, rows);
    const chosenId = chosen ? idOf(chosen) : "";
    useEffect(() => {
        if (chosenId !== "" && !tree.current?.contains(document.activeElement)) {
            setActive(chosenId);
            const row = document.getElementById(`row-${chosenId}`);
            if (row && tree.current) {
                scrollWithin(tree.current, row.offsetTop, row.offsetTop + row.offsetHeight);
            }
        }
    }, [chosenId]);
    if (rows.length === 0) {
        return <p class="hint">The scene is empty. Select a crown tool and click in the view, or type a line into the scene.</p>;
    }
    const openMenu = (object: ObjectName) => {
        const box = document.getElementById(`row-${idOf(object)}`)?.getBoundingClientRect();
        setMenu({ object, at: { x: (box?.left ?? 0) + 40, y: box?.bottom ?? 0 } });
    };
    return (
        <>
            <div
                ref={tree}
                class="object-tree"
                role="tree"
                aria-label="Objects of the scene"
                onKeyDown={(event) => {
                    if (key(event, openMenu)) {
                        event.preventDefault();
                    }
                }}
                onFocusIn={() => {
                    hadFocus.current = true;
                }}
                onFocusOut={(event) => {
                    hadFocus.current = event.relatedTarget === null; // a removed element has no related target
                }}
            >
                {rows.map((row, at) => (
                    <TreeRow
                        key={row.id}
                        app={app}
                        row={row}
                        active={at === now}
                        selected={row.id === chosenId}
                        hidden={row.object !== null && isHidden(app, row.object)}
                        focus={() => setActive(row.id)}
                        menu={(x, y) => row.object && setMenu({ object: row.object, at: { x, y } })}
                    />
                ))}
            </div>
            {menu && (
                <ContextMenu
                    app={app}
                    object={menu.object}
                    at={menu.at}
                    close={() => {
                        setMenu(null);
                        document.getElementById(`row-${idOf(menu.object)}`)?.focus();
                    }}
                />
            )}
        </>
    );
}
