// The axes of the scene in the corner of the view; a click on an end looks from there.
import type { VNode } from "preact";
import type { Studio } from "../studio";
import { useValue } from "../use";

const kFacing = 0.999;
const kReach = 30; // [px] from the centre to the end of an axis
const kEnds = [
    { name: "X", sides: ["right", "left"] },
    { name: "Y", sides: ["back", "front"] },
    { name: "Z", sides: ["top", "bottom"] },
] as const;

interface End {
    axis: number;
    sign: 1 | -1;
    x: number; // [px] from the centre
    y: number;
    near: number; // towards the camera
}

/** For the pointer only: the buttons and keys of the views have the same function. */
export function AxesBall({ studio }: { studio: Studio }): VNode | null {
    const axes = useValue(studio.view.display.axes);
    if (axes.length === 0) {
        return null;
    }
    const ends = axes
        .flatMap(([x, y, near], axis) =>
            ([1, -1] as const).map((sign): End => ({ axis, sign, x: sign * x * kReach, y: -sign * y * kReach, near: sign * near })),
        )
        .sort((a, b) => a.near - b.near);
    return (
        <div class="axes-ball" aria-hidden="true">
            {ends.map(({ axis, sign, x, y, near }) => {
                const { name, sides } = kEnds[axis];
                // If the view is already from this side, a click selects the opposite side.
                const side = sides[sign > 0 === near < kFacing ? 0 : 1];
                const line = { width: `${Math.hypot(x, y)}px`, transform: `rotate(${Math.atan2(y, x)}rad)` };
                return [
                    sign > 0 && <i key={`${name}line`} class={`axis ${name}`} style={line} />,
                    <button
                        key={`${name}${sign}`}
                        type="button"
                        tabIndex={-1}
                        class={`axis-end ${name} ${sign > 0 ? "ahead" : "behind"}`}
                        style={{ transform: `translate(${x}px, ${y}px)`, opacity: near < -0.3 ? 0.65 : 1 }}
                        title={`Look from the ${side === "bottom" ? "ground" : side}`}
                        onClick={() => studio.command(`look-${side}`)}
                    >
                        {sign > 0 ? name : ""}
                    </button>,
                ];
            })}
        </div>
    );
}
