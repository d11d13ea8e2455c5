// The menu as the engine read it from its file.

export interface MenuItem {
    number: number;
    menu: string; // the menu it stands in
    label: string;
    does: "tool" | "line" | "page" | "set" | "program" | "separator";
    text: string;
}

/** The answer to `menu`. */
export interface MenuReply {
    items: MenuItem[];
    files: string[]; // where the user's own are, or may be
    faults: string[]; // what is wrong with those
    built_in: string; // text that one's own may begin with
}

export interface Menu {
    title: string;
    items: readonly MenuItem[];
}

/** Items by their menus, in the order in which those come first. Separators at the ends of a menu, or beside each other, are left out. */
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

/** Of an item "grow.kill_radius 0.3": what it sets; null where it is none such. */
export function settingOf(text: string): { key: string; value: string } | null {
    const match = /^\s*([a-z_ ]+\.[a-z0-9_]+)\s+(\S.*?)\s*$/.exec(text);
    return match && { key: match[1], value: match[2] };
}
