// Legends: the meaning of colours, and the length of the scale bar.
import type { VNode } from "preact";
import type { App } from "../../app";
import { useValue } from "../../use";
import { cssGradient } from "../../view/colors";
import type { Legend } from "../../view/display";
import { lengthText, shortNumber, ticks } from "../../view/lengths";
import "./display.css";

const kMaxTicks = 4;

/** Numbers along the bar of a legend: its ends, and round ones between them if there is space; `at` in [0, 1]. */
export function legendTicks({ low, high }: Pick<Legend, "low" | "high">): { at: number; text: string }[] {
    if (!(high > low)) {
        return [{ at: 0.5, text: shortNumber(low) }];
    }
    const at = (value: number) => (value - low) / (high - low);
    const between = ticks(low, high, kMaxTicks).filter((value) => at(value) > 0.2 && at(value) < 0.72);
    return [low, ...between, high].map((value) => ({ at: at(value), text: shortNumber(value, 3) }));
}

function Bar({ legend }: { legend: Legend }): VNode {
    const { title, unit, map, mark } = legend;
    const markAt = mark && legend.high > legend.low ? (mark.value - legend.low) / (legend.high - legend.low) : -1;
    return (
        <figure class="legend">
            <figcaption>{unit ? `${title} [${unit}]` : title}</figcaption>
            <div class="legend-bar" style={{ backgroundImage: cssGradient(map) }}>
                {mark && markAt >= 0 && markAt <= 1 && <i class="legend-mark" style={{ left: `${markAt * 100}%` }} title={mark.label} />}
            </div>
            <ul class="legend-ticks">
                {legendTicks(legend).map(({ at, text }, k) => (
                    <li key={k} style={{ left: `${at * 100}%`, transform: `translateX(${-at * 100}%)` }}>
                        {text}
                    </li>
                ))}
            </ul>
            {mark && <span class="legend-note">{mark.label}</span>}
        </figure>
    );
}

export function Legends({ app }: { app: App }): VNode {
    const { display } = app.view;
    const legends = [useValue(display.legend), useValue(display.sliceLegend)].filter((one) => one !== null);
    return (
        <div class="legends">
            {legends.map((legend) => (
                <Bar key={legend.title} legend={legend} />
            ))}
            <ScaleBar app={app} />
        </div>
    );
}

function ScaleBar({ app }: { app: App }): VNode | null {
    const { pixels, metres } = useValue(app.view.display.scale);
    if (!(pixels > 0)) {
        return null;
    }
    const text = lengthText(metres);
    return (
        <div class="scale-bar" role="img" aria-label={`This bar is ${text} long`} style={{ width: `${pixels}px` }}>
            {text}
        </div>
    );
}
