// The menu bar: an ARIA menubar for keyboard, pointer and touch.
import type { VNode } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { kShortcuts } from "../../keys";
import type { Studio } from "../../studio";
import { useValue } from "../../use";
import { showText } from "../files/dialog";
import { kDefaults } from "../scene/defaults";
import { type Menu, type MenuItem, type MenuReply, menusOf } from "./items";
import "./menu.css";
import { isChecked, perform, unready } from "./perform";

/** Explains how to change the menu. */
async function showMenuFile(studio: Studio): Promise<void> {
    const { files, built_in } = await studio.engine.request<MenuReply>("menu");
    const where = files.length > 0 ? `Your own menu is read from:\n${files.join("\n")}\n` : "Start the studio with --menu FILE to use your own menu.\n";
    await showText("The menu is a text file", `${where}It extends the built-in menu:\n\n${built_in}`);
}

/** Reads the menu after each connection: the file may have changed. */
function useMenus(studio: Studio): readonly Menu[] {
    const [menus, setMenus] = useState<readonly Menu[]>([]);
    const connection = useValue(studio.store.connection);
    useEffect(() => {
        if (connection === "ready") {
            studio.engine.request<MenuReply>("menu").then(
                ({ items, faults }) => {
                    setMenus(menusOf(items));
                    faults.forEach((fault) => studio.store.notify(fault, "warning"));
                },
                (error: Error) => studio.store.notify(`The menu cannot be read: ${error.message}`, "error"),
            );
        }
    }, [connection]);
    return menus;
}

function shortcutOf(studio: Studio, item: MenuItem): string {
    const keys = item.does === "page" ? kShortcuts.find(({ id }) => id === item.text)?.keys[0] : undefined;
    return keys ?? (item.does === "tool" ? (studio.tools.find(({ id }) => id === item.text)?.shortcut ?? "") : "");
}

const kItems = '[role="menuitem"], [role="menuitemcheckbox"]';

function itemsIn(element: Element | null): HTMLElement[] {
    return [...(element?.querySelectorAll<HTMLElement>(kItems) ?? [])];
}

/** Moves the focus between items by a key; returns false if the key is not used. */
function stepFocus(items: readonly HTMLElement[], key: string, back: string, forth: string): boolean {
    const at = items.indexOf(document.activeElement as HTMLElement);
    const count = items.length;
    const letter = key.length === 1 && key !== " " ? key.toLowerCase() : "";
    const begins = (item: HTMLElement) => letter !== "" && (item.textContent ?? "").trim().toLowerCase().startsWith(letter);
    const next =
        key === forth
            ? (at + 1) % count
            : key === back
              ? (at - 1 + count) % count
              : key === "Home"
                ? 0
                : key === "End"
                  ? count - 1
                  : ([...items.keys()].map((n) => (at + 1 + n) % count).find((n) => begins(items[n])) ?? -1);
    items[next]?.focus();
    return next >= 0 && count > 0;
}

interface ItemProps {
    studio: Studio;
    item: MenuItem;
    take(item: MenuItem): void;
}

function Item({ studio, item, take }: ItemProps): VNode {
    if (item.does === "separator") {
        return <div role="separator" class="menu-separator" />;
    }
    const why = unready(studio, item, (id) => studio.hasCommand(id));
    const keys = shortcutOf(studio, item);
    return (
        <button
            type="button"
            class="menu-item"
            role={item.does === "set" ? "menuitemcheckbox" : "menuitem"}
            aria-checked={item.does === "set" ? isChecked(item) : undefined}
            aria-disabled={why !== ""}
            aria-keyshortcuts={keys ? keys.replace("Ctrl", "Control") : undefined}
            title={why || (item.does === "line" || item.does === "program" ? item.text : undefined)}
            tabIndex={-1}
            onPointerMove={(event) => event.currentTarget.focus()}
            onClick={() => why === "" && take(item)}
        >
            <span>{item.label}</span>
            {keys && <kbd aria-hidden="true">{keys}</kbd>}
        </button>
    );
}

interface ListProps {
    studio: Studio;
    menu: Menu;
    last: boolean; // whether the last item has the focus at first
    take(item: MenuItem): void;
    untaken(event: KeyboardEvent): void;
}

function ItemList({ studio, menu, last, take, untaken }: ListProps): VNode {
    const list = useRef<HTMLDivElement>(null);
    useValue(studio.store.state); // the enabled state depends on them
    useValue(studio.store.selection);
    useValue(studio.store.connection);
    useValue(studio.store.schema);
    useValue(kDefaults);
    useLayoutEffect(
        () =>
            itemsIn(list.current)
                .at(last ? -1 : 0)
                ?.focus(),
        [menu],
    );
    const keyDown = (event: KeyboardEvent) => {
        if (!event.ctrlKey && !event.metaKey && !event.altKey && stepFocus(itemsIn(list.current), event.key, "ArrowUp", "ArrowDown")) {
            event.preventDefault();
            event.stopPropagation();
        } else {
            untaken(event);
        }
    };
    return (
        <div class="menu-list" role="menu" aria-label={menu.title} ref={list} onKeyDown={keyDown}>
            {menu.items.map((item) => (
                <Item key={item.number} studio={studio} item={item} take={take} />
            ))}
        </div>
    );
}

/** Calls `then` when Alt was pressed and released alone. */
function useLoneAlt(then: () => void): void {
    useEffect(() => {
        let alone = false;
        const forget = () => {
            alone = false;
        };
        const down = (event: KeyboardEvent) => {
            alone = event.key === "Alt" && !event.repeat && !event.ctrlKey && !event.shiftKey && !event.metaKey;
        };
        const up = (event: KeyboardEvent) => {
            if (alone && event.key === "Alt" && !document.querySelector("dialog[open]")) {
                event.preventDefault();
                then();
            }
            alone = false;
        };
        const others = ["pointerdown", "wheel", "blur"] as const;
        addEventListener("keydown", down, true);
        addEventListener("keyup", up, true);
        others.forEach((name) => addEventListener(name, forget, true));
        return () => {
            removeEventListener("keydown", down, true);
            removeEventListener("keyup", up, true);
            others.forEach((name) => removeEventListener(name, forget, true));
        };
    }, []);
}

export function MenuBar({ studio }: { studio: Studio }): VNode {
    const menus = useMenus(studio);
    const [open, setOpen] = useState(-1);
    const [fromBelow, setFromBelow] = useState(false);
    const [at, setAt] = useState(0); // the menu in the tab order
    const bar = useRef<HTMLDivElement>(null);
    const before = useRef<HTMLElement | null>(null); // the previously focused element
    const titles = () => [...(bar.current?.querySelectorAll<HTMLElement>(".menu-title") ?? [])];

    const show = (n: number, last = false) => {
        setFromBelow(last);
        setOpen(n);
        if (n >= 0) {
            setAt(n);
        }
    };
    const leave = () => {
        show(-1);
        before.current?.focus();
    };
    const take = (item: MenuItem) => {
        leave();
        perform(studio, item);
    };
    const enter = () => {
        if (bar.current?.contains(document.activeElement)) {
            leave();
        } else {
            before.current = document.activeElement as HTMLElement | null;
            titles()[0]?.focus();
        }
    };
    const newest = useRef(enter);
    newest.current = enter;
    useEffect(() => {
        studio.menuCommand("menu", () => newest.current());
        studio.menuCommand("menu-file", () => {
            showMenuFile(studio).catch((error: Error) => studio.store.notify(error.message, "error"));
        });
    }, []);
    useLoneAlt(() => newest.current());
    useEffect(() => {
        const outside = (event: PointerEvent) => {
            if (!bar.current?.contains(event.target as Node)) {
                setOpen(-1);
            }
        };
        addEventListener("pointerdown", outside, true);
        return () => removeEventListener("pointerdown", outside, true);
    }, []);

    const barKey = (event: KeyboardEvent, n: number) => {
        if (event.key === "ArrowDown" || event.key === "ArrowUp") {
            show(n, event.key === "ArrowUp");
        } else if (event.key === "Escape") {
            leave();
        } else if (event.ctrlKey || event.metaKey || event.altKey || !stepFocus(titles(), event.key, "ArrowLeft", "ArrowRight")) {
            return;
        }
        event.preventDefault();
    };
    const listKey = (event: KeyboardEvent, n: number) => {
        event.stopPropagation(); // otherwise the title receives it too
        const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? menus.length - 1 : 0;
        if (step !== 0) {
            show((n + step) % menus.length);
            event.preventDefault();
        } else if (event.key === "Escape") {
            show(-1);
            titles()[n]?.focus();
            event.preventDefault();
        } else if (event.key === "Tab") {
            show(-1);
        }
    };
    return (
        <div
            class="menu-bar"
            role="menubar"
            aria-label="Menu"
            ref={bar}
            onFocusIn={(event) => {
                const from = event.relatedTarget as HTMLElement | null;
                if (!bar.current?.contains(from)) {
                    before.current = from;
                }
            }}
            onFocusOut={(event) => {
                if (event.relatedTarget && !bar.current?.contains(event.relatedTarget as Node)) {
                    setOpen(-1);
                }
            }}
        >
            {menus.map((menu, n) => (
                <div key={menu.title} class="menu" role="none">
                    <button
                        type="button"
                        class="menu-title"
                        role="menuitem"
                        aria-haspopup="menu"
                        aria-expanded={open === n}
                        tabIndex={n === at ? 0 : -1}
                        onFocus={() => setAt(n)}
                        onClick={() => show(open === n ? -1 : n)}
                        onPointerEnter={(event) => event.pointerType === "mouse" && open >= 0 && show(n)}
                        onKeyDown={(event) => barKey(event, n)}
                    >
                        {menu.title}
                    </button>
                    {open === n && <ItemList studio={studio} menu={menu} last={fromBelow} take={take} untaken={(event) => listKey(event, n)} />}
                </div>
            ))}
        </div>
    );
}
