// Three steps from a crown to a surface, and a fourth for scans.
import type { VNode } from "preact";
import { useEffect } from "preact/hooks";
import type { SceneObject } from "../../protocol";
import { tracked } from "../../use";
import { checking, isOf, lastCheck } from "../display/checks";
import { BarkField } from "./bark";
import type { Card } from "./card";
import { CommandCard } from "./command_card";
import type { GrowthModel } from "./model";
import { count, kMain, ShownBox, Step, CommandChoice } from "./step";
import { TreeStep } from "./tree_step";

/** Number of points in the preview, or in the existing set. */
function shownCount(card: Card): number {
    const target = card.target;
    const object = target && card.app.store.state.value.objects.find(({ kind, name }) => kind === target.kind && name === target.name);
    const shown = target && card.shown.value > 0 && card.app.view.geometry(target)?.arrays.position;
    return shown ? shown.length / 3 : (object?.count ?? 0);
}

const PointCount = tracked(({ card }: { card: Card }) => {
    const counted = shownCount(card);
    return (
        <p class="count" role="status">
            {counted > 0 ? count(counted, "points") : ""}
        </p>
    );
});

const kPointWays = [
    ["pointset generate", "Fill"],
    ["pointset near", "Over a mesh"],
    ["pointset thin", "Thin"],
    ["pointset densify", "Add"],
] as const;

const PointStep = tracked(({ model }: { model: GrowthModel }) => {
    const { app, points: card } = model;
    const { objects } = app.store.state.value;
    const done = objects.some(({ kind }) => kind === "points");
    const hasSolid = objects.some(({ kind }) => kind === "solid" || kind === "mesh");
    const changes = card.command.value === "pointset thin" || card.command.value === "pointset densify";
    const target = card.values.value.solid?.[0] ?? card.values.value.mesh?.[0] ?? "a crown";
    const counted = shownCount(card);
    const summary =
        counted > 0 && card.target
            ? count(counted, `points in ${card.target.name}`)
            : hasSolid
              ? "target points of the branches"
              : "make a crown first: select Place, or draw a profile";
    const buttons: Record<string, string> = {
        "pointset thin": "Thin the points",
        "pointset densify": "Add points",
        "pointset near": `Cover ${target} with points`,
    };
    return (
        <Step
            model={model}
            step="points"
            mark="1"
            title="Points"
            summary={summary}
            done={done}
            button={card.bound.value && !changes ? "Fill with other points" : (buttons[card.command.value] ?? `Fill ${target} with points`)}
            run={() => void card.runNew()}
            disabled={card.busy.value || (card.missing !== "" && !card.bound.value)}
        >
            <CommandCard card={card} main={kMain[card.command.value]}>
                <CommandChoice card={card} choices={kPointWays} label="Method" />
                <PointCount card={card} />
                <ShownBox app={app} object={card.target} label="Show these points" />
            </CommandCard>
        </Step>
    );
});

const Verdict = tracked(({ mesh }: { mesh: SceneObject | undefined }) => {
    const last = lastCheck.value;
    if (mesh && checking.value?.kind === "mesh" && checking.value.name === mesh.name) {
        return (
            <p class="hint" role="status">
                The check is running.
            </p>
        );
    }
    return last && isOf(last, mesh) ? (
        <p class={last.good ? "good" : "warning"} role="status">
            {last.verdict}
        </p>
    ) : null;
});

const SurfaceStep = tracked(({ model }: { model: GrowthModel }) => {
    const { app, surface: card } = model;
    const { objects } = app.store.state.value;
    const target = card.target;
    const mesh = target && objects.find(({ kind, name }) => kind === "mesh" && name === target.name);
    const hasTree = objects.some(({ kind }) => kind === "skeleton");
    const tree = card.values.value.tree?.[0];
    const summary = mesh ? `${mesh.name}: ${count(mesh.count, mesh.unit)}` : hasTree ? "one closed surface around the tree" : "needs a tree";
    return (
        <Step
            model={model}
            step="surface"
            mark="3"
            title="Surface"
            summary={summary}
            done={mesh !== undefined && mesh !== null}
            button={card.bound.value ? "Make another surface" : "Make the surface"}
            run={() => void card.runNew()}
            disabled={card.busy.value || !hasTree}
        >
            <CommandCard card={card} main={kMain.mesh}>
                <BarkField card={card} />
                <Verdict mesh={mesh ?? undefined} />
                <ShownBox app={app} object={tree ? { kind: "skeleton", name: tree } : null} label="Show the editable tree" />
                <ShownBox app={app} object={target} label="Show the surface" />
            </CommandCard>
        </Step>
    );
});

const ScanStep = tracked(({ model }: { model: GrowthModel }) => {
    const { app, scan } = model;
    const { card, sources, chosen } = scan;
    const isKnown = app.store.state.value.objects.some((object) => scan.isAbout(object));
    if (!card.schema || (scan.files.value.length === 0 && !isKnown)) {
        return null;
    }
    return (
        <Step
            model={model}
            step="scan"
            mark="4"
            title="Tree from a scan"
            summary={chosen ? `extracts a skeleton from ${chosen.label}` : "choose a mesh or points"}
            done={card.bound.value !== null}
            button="Extract its skeleton"
            run={() => void card.runNew()}
            disabled={card.busy.value || card.missing !== "" || !chosen}
        >
            <label class="tool-field">
                <span>Source</span>
                <select
                    value={chosen?.label}
                    onChange={(event) => {
                        const source = sources[event.currentTarget.selectedIndex];
                        card.begin(source.argument, source.word);
                    }}
                >
                    {sources.map(({ label }) => (
                        <option key={label} value={label}>
                            {label}
                        </option>
                    ))}
                </select>
            </label>
            <CommandCard card={card} main={kMain.extract}>
                <label class="tool-check">
                    <input
                        type="checkbox"
                        checked={scan.isReference.value}
                        onChange={(event) => {
                            scan.isReference.value = event.currentTarget.checked;
                        }}
                    />
                    <span>Load files too, to compare</span>
                </label>
                <ShownBox app={app} object={scan.scan.value} label="Show the scan" />
                <ShownBox app={app} object={card.target} label="Show the skeleton" />
            </CommandCard>
        </Step>
    );
});

export function Steps({ model }: { model: GrowthModel }): VNode {
    useEffect(() => void model.scan.look(), [model]);
    return (
        <ol class="steps">
            <PointStep model={model} />
            <TreeStep model={model} />
            <SurfaceStep model={model} />
            <ScanStep model={model} />
        </ol>
    );
}
