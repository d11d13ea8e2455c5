// All settings of the view: visible objects and their display.
import type { ComponentChildren, VNode } from "preact";
import { useMemo } from "preact/hooks";
import type { App } from "../../app";
import { setting } from "../../settings";
import { CheckField, ChoiceField } from "../../tools/kit/fields";
import { useValue } from "../../use";
import type { Coloring, SkeletonForm, SolidForm } from "../../view/display";
import { kPresetButtons, kPresetNames } from "../../view/camera/presets";
import { checkWhereUnknown } from "./checks";
import { SectionFields, SliceFields } from "./cuts";
import { Slider } from "./slider";

const kColors: readonly (readonly [Coloring, string])[] = [
    ["plain", "Plain"],
    ["radius", "Radius"],
    ["order", "Order of branching"],
    ["deviation", "Deviation of the surface"],
    ["evidence", "Evidence of the scan"],
    ["crossings", "Crossings"],
];
const kSkeletons: readonly (readonly [SkeletonForm, string])[] = [
    ["surface", "Surface"],
    ["tubes", "Tubes"],
    ["lines", "Lines"],
];
const kSolids: readonly (readonly [SolidForm, string])[] = [
    ["auto", "Automatic"],
    ["opaque", "Opaque"],
    ["glass", "Glass"],
];

/** Additional explanation of a colouring. */
const kHints: Partial<Record<Coloring, string>> = {
    deviation: "Blue: the surface is inside the cones of the skeleton; red: outside.",
    evidence: "For skeletons from files that contain the quality of the measured radii.",
    crossings: "Self-intersections of the surface that the check found.",
};

interface GroupProps {
    id: string;
    title: string;
    isOpen?: boolean; // initial state
    children: ComponentChildren;
}

function Group({ id, title, isOpen = false, children }: GroupProps): VNode {
    const open = useMemo(() => setting(`display.${id}`, isOpen), [id]);
    return (
        <details class="display-group" open={useValue(open)} onToggle={(event) => void (open.value = event.currentTarget.open)}>
            <summary>{title}</summary>
            <div class="display-fields">{children}</div>
        </details>
    );
}

function Light({ app }: { app: App }): VNode {
    const { shadow, hour, north } = app.view.display;
    const [time, turned] = [useValue(hour), useValue(north)];
    return (
        <>
            <CheckField label="Shadows" value={shadow} />
            <Slider label="Hour of the sun" value={time} low={5} high={19} step={0.25} changed={(at) => void (hour.value = Math.min(Math.max(at, 5), 19))} />
            <Slider label="Rotation of north" unit="°" value={turned} low={-180} high={180} step={5} changed={(by) => void (north.value = by)} />
        </>
    );
}

function Hands({ app }: { app: App }): VNode {
    const { preset } = app.view.display;
    const buttons = kPresetButtons[useValue(preset)];
    return (
        <>
            <ChoiceField label="Button layout of" value={preset} choices={kPresetNames} />
            <dl class="button-list">
                {buttons.map(([button, does]) => (
                    <div key={button}>
                        <dt>{button}</dt>
                        <dd>{does}</dd>
                    </div>
                ))}
            </dl>
        </>
    );
}

export function DisplayPanel({ app }: { app: App }): VNode {
    const { display } = app.view;
    const color = useValue(display.color);
    const size = useValue(display.pointSize);
    const hint = kHints[color];
    const colored = () => {
        if (display.color.peek() === "crossings") {
            void checkWhereUnknown(app);
        }
    };
    return (
        <div class="display">
            <Group id="show" title="Colours and shapes" isOpen>
                <ChoiceField label="Colours" value={display.color} choices={kColors} changed={colored} />
                {hint && <p class="hint">{hint}</p>}
                <ChoiceField label="Trees as" value={display.skeletons} choices={kSkeletons} />
                <ChoiceField label="Crowns" value={display.solids} choices={kSolids} />
                <div class="display-checks">
                    <CheckField label="Wireframe" value={display.wireframe} />
                    <CheckField label="Cage" value={display.cage} />
                    <CheckField label="Bones" value={display.bones} />
                    <CheckField label="Points" value={display.points} />
                    <CheckField label="Grid" value={display.grid} />
                    <CheckField label="Parallel view" value={display.parallel} />
                </div>
                <Slider
                    label="Size of points"
                    unit="px"
                    value={size}
                    low={1}
                    high={10}
                    step={0.5}
                    changed={(to) => void (display.pointSize.value = Math.min(Math.max(to, 0.5), 30))}
                />
            </Group>
            <Group id="section" title="Section">
                <SectionFields app={app} />
            </Group>
            <Group id="slice" title="Field of a crown">
                <SliceFields app={app} />
            </Group>
            <Group id="light" title="Sun and shadow">
                <Light app={app} />
            </Group>
            <Group id="hands" title="Mouse, trackpad, fingers">
                <Hands app={app} />
            </Group>
        </div>
    );
}
