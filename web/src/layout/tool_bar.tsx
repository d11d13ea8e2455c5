// Buttons of the tools, and the parameters of the active tool. The groups that suit the selection are open.
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import type { Tool } from "../app";
import type { Kind } from "../protocol";
import type { Studio } from "../studio";
import { Tracked, useValue } from "../use";

const kGroups: Record<Tool["group"], string> = {
    view: "View",
    crown: "Crown",
    points: "Points",
    branch: "Branches",
    compose: "Composition",
};

type Group = Tool["group"];

const kSuits: Record<Kind | "nothing", Group[]> = {
    nothing: ["crown"],
    solid: ["crown"],
    path: ["crown"],
    profile: ["crown"],
    points: ["points"],
    skeleton: ["branch", "compose"],
    mesh: [],
    material: [],
};

function ToolButton({ studio, tool, held }: { studio: Studio; tool: Tool; held: boolean }): VNode {
    useValue(studio.store.selection); // the enabled state depends on it
    useValue(studio.store.state);
    const enabled = held || !tool.enabled || tool.enabled(studio);
    return (
        <button
            type="button"
            class="tool"
            aria-pressed={held}
            disabled={!enabled}
            title={tool.shortcut ? `${tool.help} (${tool.shortcut})` : tool.help}
            onClick={() => studio.take(held ? "select" : tool.id)}
        >
            {tool.label}
        </button>
    );
}

interface GroupProps {
    studio: Studio;
    group: Group;
    held: string;
    suits: boolean;
}

function ToolGroup({ studio, group, held, suits }: GroupProps): VNode | null {
    const [chosen, choose] = useState<boolean | null>(null); // choice of the user against the automatic state
    const tools = studio.tools.filter((tool) => tool.group === group);
    if (tools.length === 0) {
        return null;
    }
    const isOpen = (chosen ?? suits) || (held !== "select" && tools.some((tool) => tool.id === held));
    return (
        <div class="tool-group" role="group" aria-label={kGroups[group]}>
            <button type="button" class="tool-heading" aria-expanded={isOpen} onClick={() => choose(!isOpen)}>
                {kGroups[group]}
            </button>
            {isOpen && tools.map((tool) => <ToolButton key={tool.id} studio={studio} tool={tool} held={tool.id === held} />)}
        </div>
    );
}

export function ToolBar({ studio }: { studio: Studio }): VNode {
    const held = useValue(studio.store.tool);
    const kind = useValue(studio.store.selection).object?.kind ?? "nothing";
    return (
        <div class="tool-bar" role="toolbar" aria-label="Tools">
            {(Object.keys(kGroups) as Group[]).map((group) => (
                // Another kind of selection resets groups that were opened by the user.
                <ToolGroup key={`${group} ${kind}`} studio={studio} group={group} held={held} suits={group === "view" || kSuits[kind].includes(group)} />
            ))}
        </div>
    );
}

// Enter in a field acts like Enter in the view.
function ends({ key, target }: KeyboardEvent): boolean {
    return key === "Enter" && target instanceof HTMLInputElement && (target.type === "number" || target.type === "text");
}

/** The parameters of the active tool, if it has any. */
export function ToolPanel({ studio }: { studio: Studio }): VNode | null {
    const run = useValue(studio.activeTool.run);
    const held = useValue(studio.store.tool);
    const tool = studio.tools.find((one) => one.id === held);
    if (!run?.panel || !tool) {
        return null;
    }
    return (
        <section class="panel tool-panel" aria-labelledby="title-tool">
            <h2 class="panel-title" id="title-tool">
                {tool.label}
            </h2>
            <div class="panel-body" onKeyDown={(event) => ends(event) && studio.activeTool.key(event)}>
                <p class="hint">{tool.help}</p>
                <Tracked draw={() => run.panel?.()} />
            </div>
        </section>
    );
}
