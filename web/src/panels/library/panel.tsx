// A library of branches: its choice, contents and additions; and trees composed from it.
import type { VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import { selectedTops } from "../../tools/kit/skeleton";
import { FieldError, useNumber } from "../../number_field";
import { tracked } from "../../use";
import { withEnding } from "../files/folder";
import { filtered, kAll, type Order, tagsOf } from "./filter";
import { BranchGrid } from "./grid";
import { kEnding, type LibraryModel } from "./model";
import { Composition } from "./seeds";

const kNew = ":new"; // no file has this name
const kOrders: readonly (readonly [Order, string])[] = [
    ["length", "longest first"],
    ["tips", "most tips first"],
    ["number", "by number"],
];

const Chooser = tracked(({ model }: { model: LibraryModel }) => {
    const [isNew, setNew] = useState(false);
    const [name, setName] = useState("");
    const files = model.files.value;
    const file = model.file.value;
    const all = file !== "" && !files.includes(file) ? [...files, file] : files;
    const make = () => {
        void model.open(withEnding(name.trim(), kEnding));
        setNew(false);
    };
    return (
        <>
            <label class="tool-field library-file">
                <span>Library</span>
                <select
                    value={isNew || file === "" ? kNew : file}
                    onChange={(event) => {
                        const chosen = event.currentTarget.value;
                        setNew(chosen === kNew);
                        if (chosen !== kNew) {
                            void model.open(chosen);
                        }
                    }}
                >
                    {all.map((one) => (
                        <option key={one} value={one}>
                            {one}
                        </option>
                    ))}
                    <option value={kNew}>New library…</option>
                </select>
            </label>
            {(isNew || file === "") && (
                <form
                    class="tool-row"
                    onSubmit={(event) => {
                        event.preventDefault();
                        make();
                    }}
                >
                    <input
                        type="text"
                        aria-label="Name of the new library"
                        placeholder="oaks"
                        value={name}
                        onInput={(event) => setName(event.currentTarget.value)}
                    />
                    <button type="submit" disabled={name.trim() === ""}>
                        Use it
                    </button>
                </form>
            )}
        </>
    );
});

const Adding = tracked(({ model }: { model: LibraryModel }) => {
    const [tag, setTag] = useState("");
    const { store } = model.app;
    const hasTrees = store.state.value.objects.some(({ kind }) => kind === "skeleton");
    const acceptsNodes = store.schema.value.some((command) => command.name === "library add" && command.arguments.some(({ name }) => name === "nodes"));
    void store.selection.value;
    if (model.file.value === "" || !hasTrees) {
        return null;
    }
    return (
        <details class="all-options" open={model.branches.value.length === 0}>
            <summary>Add branches of a tree</summary>
            <label class="tool-field">
                <span>Tag</span>
                <input type="text" placeholder="oak" value={tag} onInput={(event) => setTag(event.currentTarget.value.trim())} />
            </label>
            <div class="tool-row">
                <button type="button" onClick={() => void model.add(tag, "tree")}>
                    All of the tree
                </button>
                {acceptsNodes && (
                    <button type="button" disabled={selectedTops(model.app) === null} onClick={() => void model.add(tag, "selected")}>
                        The selected ones
                    </button>
                )}
            </div>
        </details>
    );
});

interface MetresProps {
    label: string;
    placeholder: string;
    value: number; // 0: none
    set(value: number): void;
}

function Metres({ label, placeholder, value, set }: MetresProps): VNode {
    const { field, errorText } = useNumber({ value: value || null, low: 0, take: set, clear: () => set(0) });
    return (
        <>
            <input aria-label={label} placeholder={placeholder} {...field} />
            <FieldError text={errorText} />
        </>
    );
}

const Filters = tracked(({ model }: { model: LibraryModel }) => {
    const filter = model.filter.value;
    const tags = tagsOf(model.branches.value);
    const set = (change: Partial<typeof filter>) => {
        model.filter.value = { ...filter, ...change };
    };
    return (
        <div class="filters" role="group" aria-label="Filter of the branches">
            <input
                type="search"
                aria-label="Find by number, tag or source"
                placeholder="Find"
                value={filter.text}
                onInput={(event) => set({ text: event.currentTarget.value })}
            />
            <select
                aria-label="Order"
                value={model.order.value}
                onChange={(event) => {
                    model.order.value = event.currentTarget.value as Order;
                }}
            >
                {kOrders.map(([order, text]) => (
                    <option key={order} value={order}>
                        {text}
                    </option>
                ))}
            </select>
            {tags.length > 0 && (
                <select aria-label="Tag" value={filter.tag} onChange={(event) => set({ tag: event.currentTarget.value })}>
                    <option value="">any tag</option>
                    {tags.map((tag) => (
                        <option key={tag} value={tag}>
                            {tag}
                        </option>
                    ))}
                </select>
            )}
            <Metres label="Minimum length in metres" placeholder="from [m]" value={filter.least} set={(least) => set({ least })} />
            <Metres label="Maximum length in metres" placeholder="to [m]" value={filter.most} set={(most) => set({ most })} />
        </div>
    );
});

const Branches = tracked(({ model }: { model: LibraryModel }) => {
    const all = model.branches.value;
    if (model.errorText.value) {
        return (
            <p class="error" role="alert">
                {model.errorText.value}
            </p>
        );
    }
    if (all.length === 0) {
        return (
            <p class="hint">
                {model.file.value ? "This library is empty: add branches of a tree to it." : "Choose a library of the folder, or name a new one."}
            </p>
        );
    }
    const shown = filtered(all, model.filter.value, model.order.value);
    return (
        <>
            <Filters model={model} />
            <p class="hint" role="status">
                {shown.length === all.length
                    ? `${all.length} branches. Drag one onto a tree, or select it and press Enter.`
                    : `${shown.length} of ${all.length} branches`}
                {model.filter.value !== kAll && (
                    <button
                        type="button"
                        onClick={() => {
                            model.filter.value = kAll;
                        }}
                    >
                        Show all
                    </button>
                )}
            </p>
            <BranchGrid model={model} branches={shown} />
        </>
    );
});

export function LibraryPanel({ model }: { model: LibraryModel }): VNode {
    useEffect(() => void model.look(), [model]);
    return (
        <>
            <Chooser model={model} />
            <Adding model={model} />
            <Branches model={model} />
        </>
    );
}

const OnlyShown = tracked(({ model }: { model: LibraryModel }) =>
    model.branches.value.length > 0 ? (
        <label class="tool-check">
            <input
                type="checkbox"
                checked={model.onlyShown.value}
                onChange={(event) => {
                    model.onlyShown.value = event.currentTarget.checked;
                }}
            />
            <span>Use only branches with the tag and lengths chosen in the library</span>
        </label>
    ) : null,
);

export function CompositionPanel({ model }: { model: LibraryModel }): VNode {
    return (
        <>
            <OnlyShown model={model} />
            <Composition model={model} />
        </>
    );
}
