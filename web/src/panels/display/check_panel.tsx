// Result of the check of a surface: its quality, its errors, and their positions.
import type { VNode } from "preact";
import type { App } from "../../app";
import { useValue } from "../../use";
import { shortNumber } from "../../view/lengths";
import { type Check, check, checkedObject, checking, isOf, lastCheck, showPlace } from "./checks";
import { type FigureGroup, type FigureRow, grouped } from "./figures";

function valueText({ value, unit }: FigureRow): string {
    if (typeof value === "boolean") {
        return value ? "yes" : "no";
    }
    const digits = Number.isInteger(value) ? 15 : 4;
    return `${shortNumber(value, digits)}${unit && (unit === "%" || unit === "°" ? unit : ` ${unit}`)}`;
}

export function Figures({ group }: { group: FigureGroup }): VNode {
    const bad = group.rows.filter((row) => row.isBad).length;
    return (
        <details class="display-group" open={bad > 0}>
            <summary>
                {group.title}
                {bad > 0 && <span class="flag"> {bad === 1 ? "1 to inspect" : `${bad} to inspect`}</span>}
            </summary>
            <dl class="figures">
                {group.rows.map((row) => (
                    <div key={row.label} class={row.isBad ? "bad" : undefined}>
                        <dt>{row.label}</dt>
                        <dd>{valueText(row)}</dd>
                        {row.description && <dd class="hint">{row.description}</dd>}
                    </div>
                ))}
            </dl>
        </details>
    );
}

function Places({ app, places }: { app: App; places: Check["places"] }): VNode | null {
    const chosen = useValue(app.view.display.crossing);
    if (places.length === 0) {
        return null;
    }
    return (
        <>
            <h3 class="small-heading">Positions of crossings</h3>
            <ol class="places" aria-label="Positions of crossings">
                {places.map(({ at, pairs }, k) => (
                    <li key={k}>
                        <button type="button" aria-pressed={k === chosen} title="Show this position" onClick={() => showPlace(app, places, k)}>
                            <span>{at.map((c) => shortNumber(c, 4)).join(", ")}</span>
                            {pairs > 0 && <span class="hint">{pairs === 1 ? "1 pair" : `${pairs} pairs`}</span>}
                        </button>
                    </li>
                ))}
            </ol>
        </>
    );
}

function Result({ app, found }: { app: App; found: Check }): VNode {
    const { display } = app.view;
    const color = useValue(display.color);
    const { good, verdict, figures, places, object } = found;
    const toggle = (wanted: "crossings" | "deviation") => void (display.color.value = color === wanted ? "plain" : wanted);
    return (
        <>
            <div class="tool-row">
                <button type="button" aria-pressed={color === "crossings"} disabled={places.length === 0} onClick={() => toggle("crossings")}>
                    Mark crossings
                </button>
                {object.kind === "skeleton" && (
                    <button type="button" aria-pressed={color === "deviation"} onClick={() => toggle("deviation")}>
                        Colour deviation
                    </button>
                )}
            </div>
            <p class={good ? "verdict good" : "verdict bad"}>
                <span aria-hidden="true">{good ? "✓" : "!"}</span> {verdict}
            </p>
            <Places app={app} places={places} />
            {grouped(figures).map((group) => (
                <Figures key={group.title} group={group} />
            ))}
        </>
    );
}

export function CheckPanel({ app }: { app: App }): VNode {
    useValue(app.store.selection);
    useValue(app.store.state);
    const running = useValue(checking);
    const found = useValue(lastCheck);
    const object = checkedObject(app);
    if (!object) {
        return <p class="hint">Skeletons and meshes can be checked; the scene has none yet.</p>;
    }
    const isHere = found?.object.kind === object.kind && found.object.name === object.name;
    return (
        <div class="check">
            <div class="tool-row">
                <button type="button" class="primary" disabled={running !== null} onClick={() => void check(app, object)}>
                    Check {object.kind} {object.name}
                </button>
                {running && (
                    <button type="button" onClick={() => app.engine.cancel()}>
                        Stop
                    </button>
                )}
            </div>
            <div role="status">
                {running && <p class="hint">Checking {running.name}…</p>}
                {!running && isHere && !isOf(found, object) && <p class="warning">It has changed since; check it again.</p>}
            </div>
            {isHere && found && <Result app={app} found={found} />}
            {!isHere && !running && (
                <p class="hint">
                    {object.kind === "skeleton" ? "Creates its surface, and reports its quality" : "Says"} whether that is closed, crosses itself, and how true
                    it is.
                </p>
            )}
        </div>
    );
}
