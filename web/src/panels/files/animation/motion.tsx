// The wind that a tree sways in, or how it grows.
import type { Signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useValue } from "../../../use";
import { Amount } from "./amount";
import type { Film } from "./timeline";

type WindPart = keyof Film["wind"];

const kWind: readonly { part: WindPart; label: string; low: number; high: number; step: number; title: string }[] = [
    { part: "speed", label: "Wind [m/s]", low: 0, high: 60, step: 1, title: "Mean speed; 0: calm" },
    { part: "azimuth", label: "Blows to [°]", low: -360, high: 360, step: 15, title: "Counter-clockwise from +x, seen from above" },
    { part: "gusts", label: "Gusts", low: 0, high: 1, step: 0.1, title: "How much the speed varies, as a part of it" },
    { part: "flexibility", label: "Flexibility", low: 0, high: 1000, step: 0.5, title: "Times as much as green wood bends: more for saplings and for show" },
    { part: "load", label: "Leaves", low: 0, high: 1000, step: 1, title: "Times the wood's own width that catches the wind: bare trees 3, in leaf 12 and more" },
    { part: "seed", label: "Seed", low: 0, high: 2147483647, step: 1, title: "Other gusts, other phases" },
];

export function Motion({ film }: { film: Signal<Film> }): VNode {
    const now = useValue(film);
    return now.grow ? <Growing film={film} /> : (
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
                    <span>Nodes come</span>
                    <select
                        value={age}
                        onChange={(event) => (film.value = { ...now, growing: { exponent, age: event.currentTarget.value as "length" | "order" } })}
                    >
                        <option value="length">by their way from the root</option>
                        <option value="order">in their order, as they grew</option>
                    </select>
                </label>
                <Amount
                    label="Thickening"
                    value={exponent}
                    low={1}
                    high={10}
                    step={0.5}
                    title="Exponent of the pipe model by which branches thicken: greater is earlier"
                    set={(value) => (film.value = { ...now, growing: { age, exponent: value } })}
                />
            </div>
        </section>
    );
}
