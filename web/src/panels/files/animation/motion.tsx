// The motion of a tree: wind, or growth.
import type { Signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useValue } from "../../../use";
import { Amount } from "./amount";
import type { Film } from "./timeline";

type WindPart = keyof Film["wind"];

const kWind: readonly { part: WindPart; label: string; low: number; high: number; step: number; title: string }[] = [
    { part: "speed", label: "Wind [m/s]", low: 0, high: 60, step: 1, title: "Mean wind speed; 0 is calm" },
    {
        part: "azimuth",
        label: "Direction in which the wind blows, counter-clockwise from +x seen from above",
        low: -360,
        high: 360,
        step: 15,
        title: "Counter-clockwise from +x, seen from above",
    },
    { part: "gusts", label: "Gusts", low: 0, high: 1, step: 0.1, title: "Amplitude of the gusts as a fraction of the mean wind speed" },
    {
        part: "flexibility",
        label: "Flexibility",
        low: 0,
        high: 1000,
        step: 0.5,
        title: "Factor on the bending of green wood: larger for saplings and for effect",
    },
    {
        part: "load",
        label: "Leaves",
        low: 0,
        high: 1000,
        step: 1,
        title: "Ratio of the width that catches the wind to the width of the branch: 3 for bare trees, 12 and more in leaf",
    },
    { part: "seed", label: "Seed", low: 0, high: 2147483647, step: 1, title: "Seed of the gusts and phases" },
];

export function Motion({ film }: { film: Signal<Film> }): VNode {
    const now = useValue(film);
    return now.grow ? (
        <Growing film={film} />
    ) : (
        <section class="animation-part" aria-label="Wind">
            <div class="animation-row">
                {kWind.map(({ part, ...rest }) => (
                    <Amount key={part} {...rest} value={now.wind[part]} set={(value) => (film.value = { ...now, wind: { ...now.wind, [part]: value } })} />
                ))}
            </div>
        </section>
    );
}

function Growing({ film }: { film: Signal<Film> }): VNode {
    const now = useValue(film);
    const { age, exponent } = now.growing;
    return (
        <section class="animation-part" aria-label="Growth">
            <div class="animation-row">
                <label>
                    <span>Nodes appear</span>
                    <select
                        value={age}
                        onChange={(event) => (film.value = { ...now, growing: { exponent, age: event.currentTarget.value as "length" | "order" } })}
                    >
                        <option value="length">by their distance from the root</option>
                        <option value="order">in their order, as they grew</option>
                    </select>
                </label>
                <Amount
                    label="Thickening"
                    value={exponent}
                    low={1}
                    high={10}
                    step={0.5}
                    title="Exponent of the pipe model for the thickening of branches: larger is earlier"
                    set={(value) => (film.value = { ...now, growing: { age, exponent: value } })}
                />
            </div>
        </section>
    );
}
