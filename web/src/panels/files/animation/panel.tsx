// The timeline: keys, wind and growth of a skeleton, previewed in the view and written as films.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import type { App } from "../../../app";
import { setting } from "../../../settings";
import { useValue } from "../../../use";
import { Amount } from "./amount";
import "./animation.css";
import { exportFilm } from "./film";
import { KeyEditor } from "./key_editor";
import { Motion } from "./motion";
import { Player } from "./player";
import { type Film, frameCount, type Key, kFirstFilm, moves } from "./timeline";
import { Track } from "./track";

const kKept = setting<string>("animation", "");

function storedFilm(): Film {
    try {
        return { ...kFirstFilm, ...(JSON.parse(kKept.peek()) as Partial<Film>) };
    } catch {
        return kFirstFilm;
    }
}

/** The edited film, stored by the browser. */
const kFilm: Signal<Film> = signal(storedFilm());
effect(() => {
    kKept.value = JSON.stringify(kFilm.value);
});
/** The edited key. */
const kChosen: Signal<Key | null> = signal(null);

/** The tree of the film; if it no longer exists, the selected skeleton, or the first one. */
function treesOf(app: App): { trees: string[]; tree: string } {
    const trees = app.store.state.value.objects.filter(({ kind }) => kind === "skeleton").map(({ name }) => name);
    const { object } = app.store.selection.value;
    const selected = object?.kind === "skeleton" ? object.name : "";
    const { tree } = kFilm.value;
    return { trees, tree: trees.includes(tree) ? tree : selected || (trees[0] ?? "") };
}

export function AnimationPanel({ app }: { app: App }): VNode {
    useValue(app.store.state);
    useValue(app.store.selection);
    const film = useValue(kFilm);
    const { trees, tree } = treesOf(app);
    useEffect(() => {
        if (tree !== "" && tree !== film.tree) {
            kFilm.value = { ...film, tree };
        }
    }, [tree, film]);
    const player = useMemo(() => new Player(app, kFilm), []);
    useEffect(() => () => player.dispose(), []);
    if (tree === "") {
        return <p class="animation hint">Skeletons can be moved by keys and wind, or grow; the scene has none yet.</p>;
    }
    return (
        <div class="animation">
            <div class="animation-row" role="group" aria-label="Film">
                <PlayButtons app={app} player={player} film={film} />
                <label>
                    <span>Tree</span>
                    <select value={tree} onChange={(event) => (kFilm.value = { ...film, tree: event.currentTarget.value })}>
                        {trees.map((name) => (
                            <option key={name} value={name}>
                                {name}
                            </option>
                        ))}
                    </select>
                </label>
                <label>
                    <span>Motion</span>
                    <select value={film.grow ? "grow" : "move"} onChange={(event) => (kFilm.value = { ...film, grow: event.currentTarget.value === "grow" })}>
                        <option value="move">keys and wind</option>
                        <option value="grow">growth</option>
                    </select>
                </label>
                <Amount label="Lasts [s]" value={film.duration} low={0.1} high={3600} step={0.5} set={(duration) => (kFilm.value = { ...film, duration })} />
                <Amount label="Frames/s" value={film.rate} low={1} high={240} step={1} set={(rate) => (kFilm.value = { ...film, rate })} />
                <button type="button" disabled={!moves(film)} onClick={() => void exportFilm(app, film)}>
                    Export…
                </button>
            </div>
            <Track film={kFilm} chosen={kChosen} player={player} />
            <AnimationStatus player={player} film={film} />
            <div class="animation-parts">
                {!film.grow && <KeyEditor app={app} film={kFilm} chosen={kChosen} player={player} />}
                <Motion film={kFilm} />
            </div>
        </div>
    );
}

function PlayButtons({ app, player, film }: { app: App; player: Player; film: Film }): VNode {
    const playing = useValue(player.playing);
    const open = useValue(player.open);
    const fetched = useValue(player.fetched);
    const form = useValue(app.view.display.skeletons);
    return (
        <>
            <button type="button" class="primary" disabled={!moves(film)} onClick={() => (playing ? player.pause() : player.play())}>
                {playing ? "❚❚ Pause" : "▶ Play"}
            </button>
            <button type="button" class="icon" disabled={!open} aria-label="At rest" title="Shows the tree at rest" onClick={() => player.close()}>
                ■
            </button>
            {open && <span class="frames-here hint" title="Available frames">{`${fetched} of ${frameCount(film)}`}</span>}
            {open && form !== "surface" && (
                <button type="button" onClick={() => (app.view.display.skeletons.value = "surface")}>
                    Show surfaces to see it
                </button>
            )}
        </>
    );
}

function AnimationStatus({ player, film }: { player: Player; film: Film }): VNode {
    const errorText = useValue(player.errorText);
    const text = errorText || (moves(film) ? "" : "There is no motion: add a key, or a wind.");
    return (
        <p class={errorText ? "animation-status error" : "animation-status hint"} role="status">
            {text}
        </p>
    );
}
