// The branches of a library as a grid of images: for mouse, touch and keyboard.
import type { VNode } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import { chosenBranch, libraryGraftHeld } from "../../tools/branch/library_graft";
import { useValue } from "../../use";
import { BranchDrag } from "./drag";
import { type Branch, lengthText, stepInGrid } from "./filter";
import type { LibraryModel } from "./model";
import { Picture } from "./pictures";

interface CellProps {
    model: LibraryModel;
    branch: Branch;
    chosen: boolean;
    focusable: boolean;
}

function Cell({ model, branch, chosen, focusable }: CellProps): VNode {
    const file = model.file.peek();
    const drag = useMemo(() => new BranchDrag(model.app, { file, number: branch.number }), [file, branch.number]);
    useEffect(() => () => drag.cancel(), [drag]);
    const tips = `${branch.tips} ${branch.tips === 1 ? "tip" : "tips"}`;
    return (
        <div
            role="option"
            class="branch"
            id={`branch-${branch.number}`}
            aria-selected={chosen}
            title={`Branch ${branch.number} of ${branch.source}: ${branch.nodes} nodes, ${branch.orders} orders, ${lengthText(branch.radius)} thick${branch.leads ? ", continues its parent" : ""}`}
            tabIndex={focusable ? 0 : -1}
            onClick={() => {
                chosenBranch.value = { file, number: branch.number };
            }}
            onPointerDown={(event) => drag.down(event)}
            onPointerMove={(event) => drag.move(event)}
            onPointerUp={(event) => drag.up(event)}
            onPointerCancel={() => drag.cancel()}
        >
            <span class="branch-number">{branch.number}</span>
            <Picture id={`${file}/${branch.number}`} load={() => model.skeleton(branch.number)} />
            <span class="branch-text">{lengthText(branch.length)}</span>
            <span class="branch-text">{[tips, ...branch.tags].join(", ")}</span>
        </div>
    );
}

function columnsOf(list: HTMLElement): number {
    const [first, ...rest] = [...list.children] as HTMLElement[];
    const next = rest.findIndex((cell) => cell.offsetTop > first.offsetTop);
    return next < 0 ? Math.max(list.children.length, 1) : next + 1;
}

export function BranchGrid({ model, branches }: { model: LibraryModel; branches: readonly Branch[] }): VNode {
    const list = useRef<HTMLDivElement>(null);
    const chosen = useValue(chosenBranch);
    const at = Math.max(
        branches.findIndex(({ number }) => number === chosen?.number),
        0,
    );
    const choose = (index: number) => {
        chosenBranch.value = { file: model.file.peek(), number: branches[index].number };
        const cell = list.current?.children[index] as HTMLElement | undefined;
        cell?.focus();
        cell?.scrollIntoView({ block: "nearest" });
    };
    const key = (event: KeyboardEvent) => {
        if (event.key === "Enter" || event.key === " ") {
            choose(at);
            if (event.key === "Enter") {
                model.app.take("library-graft");
                void libraryGraftHeld()?.showOnSelected();
                model.app.view.element().focus();
            }
            event.preventDefault();
            return;
        }
        const next = list.current && stepInGrid(event.key, at, branches.length, columnsOf(list.current));
        if (next !== null) {
            choose(next);
            event.preventDefault();
        }
    };
    return (
        <div class="branches" ref={list} role="listbox" aria-label="Branches of the library" onKeyDown={key}>
            {branches.map((branch, index) => (
                <Cell
                    key={`${model.file.peek()}/${branch.number}`}
                    model={model}
                    branch={branch}
                    chosen={branch.number === chosen?.number}
                    focusable={index === at}
                />
            ))}
        </div>
    );
}
