// State of the document and of the view.
import { signal } from "@preact/signals-core";
import type { Connection, Message, Pick, Selection, Store } from "./app";
import type { Command, ObjectName, State } from "./protocol";

const kMaxMessages = 50;

export const kEmptyState: State = {
    revision: 0,
    by: "",
    statements: [],
    ran: 0,
    running: null,
    doing: "",
    error: null,
    objects: [],
    undo: [],
    redo: [],
    file: "",
    saved: true,
    recovered: false,
};

export function createStore(): Store {
    const state = signal<State>(kEmptyState);
    const messages = signal<Message[]>([]);
    const hidden = signal<ReadonlySet<string>>(new Set<string>());
    const replaced = new Map<string, Replaced>();
    const store: Store = {
        state,
        messages,
        schema: signal<Command[]>([]),
        connection: signal<Connection>("connecting"),
        folder: signal(""),
        progress: signal(null),
        grown: signal(null),
        keepsGrowthPreview: signal(false),
        selection: signal<Selection>({ object: null, nodes: [], extent: "branch" }),
        hover: signal<Pick | null>(null),
        hidden,
        tool: signal("select"),
        notify(text, level = "info") {
            messages.value = [...messages.peek(), { level, text }].slice(-kMaxMessages);
        },
        hideFor(objects, by) {
            const shown = objects.map(keyOf).filter((key) => !hidden.peek().has(key));
            const keys = [...(replaced.get(keyOf(by))?.keys ?? []), ...shown];
            replaced.set(keyOf(by), { keys, by, isHidden: true });
            setHidden(store, shown, true);
        },
        find(kind, name) {
            return state.peek().objects.find((object) => object.kind === kind && object.name === name);
        },
        freeName(base) {
            const taken = new Set(state.peek().objects.map((object) => object.name));
            let name = base;
            for (let n = 2; taken.has(name); ++n) {
                name = `${base}${n}`;
            }
            return name;
        },
    };
    state.subscribe(() => followReplaced(store, replaced.values()));
    return store;
}

/** Objects that are hidden as long as another one exists, which shows them in another form. */
interface Replaced {
    keys: string[];
    by: ObjectName;
    isHidden: boolean;
}

// Undo removes the object for which others were hidden, redo restores it.
function followReplaced(store: Store, all: Iterable<Replaced>): void {
    for (const one of all) {
        const isThere = store.find(one.by.kind, one.by.name) !== undefined;
        if (isThere !== one.isHidden) {
            one.isHidden = isThere;
            setHidden(store, one.keys, isThere);
        }
    }
}

function setHidden({ hidden }: Store, keys: readonly string[], isHidden: boolean): void {
    const others = [...hidden.peek()].filter((key) => !keys.includes(key));
    hidden.value = new Set(isHidden ? [...others, ...keys] : others);
}

function keyOf({ kind, name }: ObjectName): string {
    return `${kind}:${name}`;
}

/** The state with the line that failed, also within a block: messages begin with it, as "tree.coppice:12: ". */
export function placed(state: State): State {
    const { error } = state;
    const [, line, message] = /^[^\n]*?:(\d+): ([^]*)$/.exec(error?.message ?? "") ?? [];
    return error && Number(line) >= error.line ? { ...state, error: { ...error, line: Number(line), message } } : state;
}

/** Removes objects and nodes that no longer exist from the selection. */
export function pruneSelection(store: Store): void {
    const { object } = store.selection.peek();
    if (object && !store.find(object.kind, object.name)) {
        store.selection.value = { ...store.selection.peek(), object: null, nodes: [] };
    }
}
