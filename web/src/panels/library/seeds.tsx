// Trees composed from the branches of the library: replaced branches, amount of variation, and seeds to choose from by their
// images.
import { useEffect, useState } from "preact/hooks";
import type { Argument } from "../../protocol";
import { tracked } from "../../use";
import { contextOf, CardState } from "../grow/command_card";
import { ArgumentField } from "../scene/forms/argument_field";
import type { LibraryModel } from "./model";
import { Picture } from "./pictures";

const kSeeds = 8;
const kWait = 350; // [ms] after the last change of the options, before trees are recomputed

const kGroups: readonly { title: string; names: readonly string[] }[] = [
    { title: "Replace", names: ["probability", "depth", "tolerance", "order_tolerance"] },
    { title: "Randomise", names: ["turn", "roll", "phototropism", "pose"] },
    { title: "Spacing", names: ["clearance", "tries", "crown"] },
];
const kElsewhere = new Set(["name", "template", "library", "seed"]);

const Thumbnail = tracked(({ model, seed, line }: { model: LibraryModel; seed: number; line: string }) => {
    const { card } = model;
    const template = model.template();
    const isKept = card.bound.value !== null && card.values.value.seed?.[0] === String(seed);
    return (
        <button type="button" class="seed-picture" aria-pressed={isKept} disabled={card.busy.value} title={line} onClick={() => model.keep(seed)}>
            <Picture id={`${template?.version ?? 0} ${model.branches.value.length} ${line}`} load={() => model.trial(line)} />
            <span>{`Seed ${seed}`}</span>
        </button>
    );
});

const Thumbnails = tracked(({ model }: { model: LibraryModel }) => {
    const first = model.firstSeed.value;
    const lines = Array.from({ length: kSeeds }, (_, i) => model.trialLine(first + i)).join("\n");
    const [shown, setShown] = useState({ first, lines });
    useEffect(() => {
        const timer = setTimeout(() => setShown({ first, lines }), kWait);
        return () => clearTimeout(timer);
    }, [first, lines]);
    if (lines.trim() === "") {
        return null;
    }
    return (
        <>
            <div class="seeds" role="group" aria-label="Seeds: each creates another tree">
                {shown.lines.split("\n").map((line, i) => (
                    <Thumbnail key={shown.first + i} model={model} seed={shown.first + i} line={line} />
                ))}
            </div>
            <div class="tool-row">
                <button type="button" disabled={first <= 1} onClick={() => step(model, -kSeeds)}>
                    Previous seeds
                </button>
                <button type="button" onClick={() => step(model, kSeeds)}>
                    More seeds
                </button>
                <button type="button" onClick={() => step(model, Math.floor(Math.random() * 9999) + 1 - first)}>
                    <span aria-hidden="true">⚄</span> By chance
                </button>
            </div>
        </>
    );
});

function step(model: LibraryModel, by: number): void {
    model.firstSeed.value = Math.max(model.firstSeed.peek() + by, 1);
}

const Fields = tracked(({ model }: { model: LibraryModel }) => {
    const { card } = model;
    const context = contextOf(card);
    const field = (argument: Argument) => <ArgumentField key={argument.name} argument={argument} context={context} />;
    const named = (name: string) => card.arguments.find((argument) => argument.name === name);
    const grouped = new Set(kGroups.flatMap(({ names }) => names));
    const rest = card.arguments.filter(({ name }) => !grouped.has(name) && !kElsewhere.has(name));
    return (
        <>
            {kGroups.map(({ title, names }) => (
                <details key={title} class="all-options" open={title === "Replace"}>
                    <summary>{title}</summary>
                    {names.flatMap((name) => named(name) ?? []).map(field)}
                </details>
            ))}
            <details class="all-options">
                <summary>All options</summary>
                {rest.map(field)}
            </details>
        </>
    );
});

export const Composition = tracked(({ model }: { model: LibraryModel }) => {
    const { app, card } = model;
    const trees = app.store.state.value.objects.filter(({ kind }) => kind === "skeleton");
    if (trees.length === 0) {
        return <p class="hint">Grow, draw or load a tree first: its branches are replaced by others.</p>;
    }
    const template = card.values.value.template?.[0] ?? "";
    return (
        <div class="command-card">
            <CardState card={card} />
            <label class="tool-field">
                <span>Template</span>
                <select value={template} onChange={(event) => card.set("template", [event.currentTarget.value], true)}>
                    {trees.map(({ name }) => (
                        <option key={name} value={name}>
                            {name}
                        </option>
                    ))}
                </select>
            </label>
            <p class="hint">
                {card.values.value.library
                    ? `Uses branches of ${card.values.value.library[0]}.`
                    : "Without a library, the branches of the template are rearranged."}
            </p>
            <Thumbnails model={model} />
            <Fields model={model} />
        </div>
    );
});
