// The view of the profile editor, with a button for every control point.
import type { VNode } from "preact";
import { numberWord } from "../kit/words";
import { gridStep, outlinePath, type Place, placeText, type Plane, toPixel, toPlace } from "./plane";

interface Props {
    points: readonly Place[];
    closed: boolean;
    smooth: boolean;
    active: number;
    plane: Plane;
    size: readonly [number, number]; // [px] of the view
    choose(index: number, held: boolean): void;
    add(x: number, y: number, snap: boolean): void;
    drag(x: number, y: number, snap: boolean): void;
    drop(): void;
    pan(dx: number, dy: number): void;
    zoom(x: number, y: number, factor: number): void;
}

const kMaxLines = 80;
const kMargin = 4; // [px] between the numbers of the grid and their lines

function gridLines(plane: Plane, width: number, height: number): VNode[] {
    const step = gridStep(plane);
    // Numbers are placed at the axes, or at the closer edge if an axis is not visible.
    const [left, top] = toPixel(plane, [0, 0]);
    const [labelX, labelY] = [Math.min(Math.max(left, 0), width - 30), Math.min(Math.max(top, 0), height - 16)];
    const number = (value: number) => numberWord(value * step, step);
    const [low, high] = toPlace(plane, 0, 0);
    const [right, bottom] = toPlace(plane, width, height);
    const lines: VNode[] = [];
    for (let x = Math.ceil(low / step), n = 0; x * step <= right && n < kMaxLines; ++x, ++n) {
        const [at] = toPixel(plane, [x * step, 0]);
        lines.push(<line key={`x${x}`} class={x === 0 ? "axis" : ""} x1={at} x2={at} y1={0} y2={height} />);
        lines.push(
            <text key={`tx${x}`} x={at + kMargin} y={labelY + 12}>
                {number(x)}
            </text>,
        );
    }
    for (let y = Math.ceil(bottom / step), n = 0; y * step <= high && n < kMaxLines; ++y, ++n) {
        const [, at] = toPixel(plane, [0, y * step]);
        lines.push(<line key={`y${y}`} class={y === 0 ? "axis" : ""} x1={0} x2={width} y1={at} y2={at} />);
        if (y !== 0) {
            lines.push(
                <text key={`ty${y}`} x={labelX + kMargin} y={at - kMargin}>
                    {number(y)}
                </text>,
            );
        }
    }
    return lines;
}

function place(event: PointerEvent | WheelEvent): [number, number] {
    const svg = (event.currentTarget as Element).closest("svg");
    const box = svg?.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
}

export function PlaneView(props: Props): VNode {
    const { points, closed, smooth, active, plane } = props;
    let mode: "none" | "point" | "pan" = "none";
    let last: [number, number] = [0, 0];
    const follow = (svg: SVGSVGElement, id: number) => {
        svg.setPointerCapture(id);
        svg.onpointermove = (event) => {
            const now = place(event);
            if (mode === "point") {
                props.drag(now[0], now[1], event.ctrlKey);
            } else if (mode === "pan") {
                props.pan(now[0] - last[0], now[1] - last[1]);
            }
            last = now;
        };
        svg.onpointerup = svg.onpointercancel = () => {
            svg.onpointermove = svg.onpointerup = svg.onpointercancel = null;
            if (mode === "point") {
                props.drop();
            }
            mode = "none";
        };
    };
    const press = (event: PointerEvent) => {
        const svg = event.currentTarget as SVGSVGElement;
        last = place(event);
        const index = Number((event.target as Element).getAttribute("data-point") ?? -1);
        const hit = (event.target as Element).hasAttribute("data-point");
        mode = event.button !== 0 || event.shiftKey ? "pan" : "point";
        if (mode === "point") {
            if (hit) {
                props.choose(index, true);
            } else {
                props.add(last[0], last[1], event.ctrlKey);
            }
        }
        follow(svg, event.pointerId);
        event.preventDefault();
    };
    const wheel = (event: WheelEvent) => {
        const [x, y] = place(event);
        props.zoom(x, y, Math.exp(-event.deltaY / 800));
        event.preventDefault();
    };
    const step = 1 / plane.scale;
    return (
        <svg
            class="plane"
            role="group"
            aria-label="Plane of the profile: the upright line is the axis of revolution. Arrow keys move the selected point."
            onPointerDown={press}
            onWheel={wheel}
            onContextMenu={(event) => event.preventDefault()}
        >
            <g class="grid" aria-hidden="true">
                {gridLines(plane, ...props.size)}
            </g>
            <path class={closed ? "outline closed" : "outline"} d={outlinePath(points, closed, smooth, plane)} />
            {points.map((point, i) => {
                const [x, y] = toPixel(plane, point);
                return (
                    <circle
                        key={i}
                        class={i === active ? "control active" : "control"}
                        data-point={i}
                        cx={x}
                        cy={y}
                        r={7}
                        tabindex={0}
                        role="button"
                        aria-pressed={i === active}
                        aria-label={`Point ${i + 1} at ${placeText(point, step)}`}
                        onFocus={() => mode === "none" && i !== active && props.choose(i, false)}
                    />
                );
            })}
        </svg>
    );
}
