// The selected key, and the creation of new ones.
import type { Signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type { App } from "../../../app";
import { useValue } from "../../../use";
import { withEnding, writing } from "../folder";
import { Amount } from "./amount";
import type { Player } from "./player";
import { type Film, freeTime, kEasings, type Key, keysText, lastEdit, withKey, withoutKey } from "./timeline";

interface EditorProps {
    app: App;
    film: Signal<Film>;
    chosen: Signal<Key | null>;
    player: Player;
}

export function KeyEditor({ app, film, chosen, player }: EditorProps): VNode {
    const now = useValue(film);
    const key = useValue(chosen);
    const { statements, revision } = useValue(app.store.state);
    const last = lastEdit(statements, now.tree);
    const isThere = key !== null && now.keys.includes(key);
    const add = (edits: string) => {
        const next: Key = { time: freeTime(now, player.time.peek()), easing: "smooth", edits };
        film.value = withKey(now, next);
        chosen.value = next;
    };
    // The edit is removed from the scene: otherwise the tree at rest would include it.
    const turn = async () => {
        if (!last) {
            return;
        }
        const text = statements
            .filter((_, at) => at !== last.statement)
            .map((statement) => `${statement.text}\n`)
            .join("");
        try {
            await app.engine.request("text", { text, revision, name: "turning an edit into a key" });
            add(last.edits);
        } catch (error) {
            app.store.notify((error as Error).message, "error");
        }
    };
    return (
        <section class="animation-part" aria-label="Keys of the film">
            <div class="animation-row">
                <button type="button" onClick={() => add("rest")}>
                    Add a key here
                </button>
                <button
                    type="button"
                    disabled={!last}
                    title={last ? `Removes "edit ${last.edits}" from the scene and makes it a key` : "Bend, rotate or move a branch of this tree first"}
                    onClick={() => void turn()}
                >
                    Convert the last edit to a key
                </button>
                <button type="button" disabled={now.keys.length === 0} onClick={() => void saveKeys(app, now)}>
                    Save keys
                </button>
            </div>
            {isThere ? (
                <ChosenKey key={String(key.time)} film={film} chosen={chosen} mine={key} />
            ) : (
                <p class="hint">
                    {now.keys.length > 0 ? "Select a key on the track to change it." : "A key is a list of edits of the tree at a time, or rest."}
                </p>
            )}
        </section>
    );
}

function ChosenKey({ film, chosen, mine }: { film: Signal<Film>; chosen: Signal<Key | null>; mine: Key }): VNode {
    const set = (change: Partial<Key>) => {
        const next = { ...mine, ...change };
        film.value = withKey(film.peek(), next, mine);
        chosen.value = next;
    };
    return (
        <div class="animation-row">
            <Amount label="At [s]" value={mine.time} low={0} high={3600} step={0.1} set={(time) => set({ time: freeTime(film.peek(), time, mine) })} />
            <label>
                <span>Transition</span>
                <select value={mine.easing} onChange={(event) => set({ easing: event.currentTarget.value as Key["easing"] })}>
                    {kEasings.map(([easing, label]) => (
                        <option key={easing} value={easing}>
                            {label}
                        </option>
                    ))}
                </select>
            </label>
            <label class="key-edits">
                <span>Edits</span>
                <input
                    type="text"
                    value={mine.edits}
                    spellcheck={false}
                    placeholder="rest"
                    title="Edits as in coppice edit, separated by semicolons: bend near(0,0,3) 20; twist roots 40"
                    onChange={(event) => set({ edits: event.currentTarget.value.trim() || "rest" })}
                />
            </label>
            <button
                type="button"
                onClick={() => {
                    film.value = withoutKey(film.peek(), mine);
                    chosen.value = null;
                }}
            >
                Remove
            </button>
        </div>
    );
}

/** As a file that `coppice animate --keys` reads. */
async function saveKeys(app: App, film: Film): Promise<void> {
    const file = withEnding(`${film.tree}.keys`, ".txt");
    try {
        const text = new Blob([keysText(film.keys)], { type: "text/plain" });
        if (await writing(app, file, (overwrite) => app.engine.upload(file, text, overwrite))) {
            app.store.notify(`Saved ${file}: coppice animate ${film.tree}.swc --keys ${file} -o ${film.tree}.gif`);
        }
    } catch (error) {
        app.store.notify((error as Error).message, "error");
    }
}
