// Growth of a tree: radii shown as balls, the intermediate result, and stopping.
import { useEffect } from "preact/hooks";
import { tracked } from "../../use";
import { Balls, isRadius, reachOf } from "./balls";
import { CommandCard } from "./command_card";
import type { GrowthModel } from "./model";
import { count, kMain, ShownBox, Step, CommandChoice } from "./step";

const Running = tracked(({ model }: { model: GrowthModel }) => {
    const now = model.growth.now.value;
    const { progress } = model.app.store;
    if (!now) {
        return null;
    }
    const so = now.nodes > 0 ? count(now.nodes, "nodes") : "";
    return now.phase === "running" ? (
        <div class="growing" role="group" aria-label="Growth">
            <progress aria-label="Progress of the growth" value={progress.value?.fraction} max={1} />
            <span role="status">{so ? `${so} so far` : "begins"}</span>
            <button type="button" onClick={() => model.app.engine.cancel()}>
                Stop
            </button>
        </div>
    ) : (
        <div class="growing stopped" role="group" aria-label="Growth that was stopped">
            <p role="status">{`Stopped with ${so}. Keep the tree in this state, or discard it?`}</p>
            <button type="button" class="primary" onClick={() => model.growth.keep(model.tree)}>
                Keep it
            </button>
            <button type="button" onClick={() => model.growth.throwAway(model.tree)}>
                Discard it
            </button>
        </div>
    );
});

/** Number of points inside the radii, at the pointer. */
const ReachText = tracked(({ model }: { model: GrowthModel }) => {
    const { app, tree: card } = model;
    const pointer = app.store.hover.value?.point ?? null;
    const command = card.schema;
    const geometry = model.attractors.of(card.values.value.points?.[0]);
    if (!command || !geometry || card.command.value !== "grow") {
        return null;
    }
    const { at, pulling, removed, all } = reachOf(geometry, command, card.values.value, pointer);
    const where = at === "pointer" ? "At the pointer" : "At the root";
    return <p class="count">{`${where} ${count(pulling, "")}of ${count(all, "points")} attract, ${count(removed, "")}are removed.`}</p>;
});

function BallsInPicture({ model }: { model: GrowthModel }): null {
    useEffect(() => {
        const balls = new Balls(model.app);
        const stop = model.showBalls(balls);
        return () => {
            stop();
            balls.stop();
        };
    }, [model]);
    return null;
}

export const TreeStep = tracked(({ model }: { model: GrowthModel }) => {
    const { app, tree: card } = model;
    const { objects } = app.store.state.value;
    const done = objects.some(({ kind }) => kind === "skeleton");
    const needsPoints = card.command.value === "grow" && !objects.some(({ kind }) => kind === "points");
    const target = card.target;
    const tree = target && objects.find(({ kind, name }) => kind === "skeleton" && name === target.name);
    const summary = tree ? `${tree.name}: ${count(tree.count, tree.unit)}` : needsPoints ? "needs points, or grows by rules" : "grows towards the points";
    const limit = card.values.value.max_iterations?.[0];
    const points = card.values.value.points?.[0];
    return (
        <Step
            model={model}
            step="tree"
            mark="2"
            title="Tree"
            summary={summary}
            done={done}
            button={card.bound.value ? "Grow another tree" : "Grow a tree"}
            run={() => void card.runNew()}
            disabled={card.busy.value || needsPoints}
            notice={<Running model={model} />}
        >
            <CommandCard
                card={card}
                main={kMain[card.command.value]}
                focus={(name) => {
                    model.radius.value = name !== null && isRadius(name) ? name : null;
                }}
            >
                <CommandChoice
                    card={card}
                    choices={[
                        ["grow", "Into points"],
                        ["sprout", "By rules"],
                    ]}
                    label="Growth method"
                />
                {limit && card.bound.value && (
                    <p class="standing">
                        <span>{`It was stopped after ${limit} steps.`}</span>
                        <button type="button" onClick={() => card.set("max_iterations", [], true)}>
                            Continue the growth
                        </button>
                    </p>
                )}
                <ReachText model={model} />
                <ShownBox app={app} object={points ? { kind: "points", name: points } : null} label="Show the points" />
                <BallsInPicture model={model} />
            </CommandCard>
        </Step>
    );
});
