// Elements over the view: buttons for standard views, the legend of colours, and a scale bar.
import type { VNode } from "preact";
import { Legends } from "../panels/display/legends";
import type { Studio } from "../studio";
import { AxesBall } from "./axes_ball";

const kButtons: [string, string, string][] = [
    ["look-front", "Front", "Look from the front (Numpad 1, Alt+1)"],
    ["look-right", "Side", "Look from the right (Numpad 3, Alt+3)"],
    ["look-top", "Top", "Look from above (Numpad 7, Alt+7)"],
    ["frame", "Frame", "Frame the selection, or everything (F)"],
];

export function ViewButtons({ studio }: { studio: Studio }): VNode {
    return (
        <>
            <div class="view-buttons" role="toolbar" aria-label="Views">
                {kButtons.map(([id, label, title]) => (
                    <button key={id} type="button" title={title} onClick={() => studio.command(id)}>
                        {label}
                    </button>
                ))}
            </div>
            <AxesBall studio={studio} />
            <Legends app={studio} />
        </>
    );
}
