// The menu as read from its file by the engine.

export interface MenuItem {
    number: number;
    menu: string; // the menu that contains it
    label: string;
    does: "tool" | "line" | "page" | "set" | "program" | "separator";
    text: string;
}

/** The response to `menu`. */
export interface MenuReply {
    items: MenuItem[];
    files: string[]; // paths of the menu files of the user
    faults: string[]; // errors in these files
    built_in: string; // text of the built-in menu
}

export interface Menu {
    title: string;
    items: readonly MenuItem[];
}

/**
 * Items by menu, in the order in which the menus first occur. Separators at the ends of a menu and repeated separators are
 * omitted.
 */
export function menusOf(items: readonly MenuItem[]): Menu[] {
    const titles = [...new Set(items.map(({ menu }) => menu))];
    return titles.map((title) => {
        const mine = items.filter(({ menu }) => menu === title).map((item) => ({ ...item, label: item.label.replace("...", "…") }));
        const isSeparator = (item: MenuItem | undefined) => item?.does === "separator";
        const shown = mine.filter((item, at) => {
            const rest = mine.slice(at + 1);
            return !isSeparator(item) || (at > 0 && !isSeparator(mine[at - 1]) && rest.some((one) => !isSeparator(one)));
        });
        return { title, items: shown };
    });
}

/** The setting of an item "grow.kill_radius 0.3"; null if it is invalid. */
export function settingOf(text: string): { key: string; value: string } | null {
    const match = /^\s*([a-z_ ]+\.[a-z0-9_]+)\s+(\S.*?)\s*$/.exec(text);
    return match && { key: match[1], value: match[2] };
}
