// Columns of panels at the sides of the view and tabs below it: each can be folded, and the width of each column can be changed.
import { computed, type Signal } from "@preact/signals-core";
import type { ComponentChildren, VNode } from "preact";
import { useMemo } from "preact/hooks";
import type { Panel } from "../app";
import { setting } from "../settings";
import type { Studio } from "../studio";
import { useValue } from "../use";

const kMin = 180; // [px]
const kMax = 640;
const kKeyStep = 16;

interface SplitterProps {
    label: string;
    size: Signal<number>; // [px] size of the resized element; 0: folded
    away: 1 | -1; // whether a move to the right or down enlarges it
    horizontal?: boolean; // a horizontal bar
    controls: string;
}

function limit(size: number): number {
    return size < kMin / 2 ? 0 : Math.min(Math.max(size, kMin), kMax);
}

function Splitter({ label, size, away, horizontal, controls }: SplitterProps): VNode {
    const now = useValue(size);
    const drag = (event: PointerEvent) => {
        const bar = event.currentTarget as HTMLElement;
        const from = (horizontal ? event.clientY : event.clientX) * away - size.peek();
        bar.setPointerCapture(event.pointerId);
        bar.onpointermove = (moved) => {
            size.value = limit((horizontal ? moved.clientY : moved.clientX) * away - from);
        };
        bar.onpointerup = () => {
            bar.onpointermove = null;
        };
    };
    const key = (event: KeyboardEvent) => {
        const [less, more] = horizontal ? ["ArrowUp", "ArrowDown"] : ["ArrowLeft", "ArrowRight"];
        const step = event.key === more ? kKeyStep * away : event.key === less ? -kKeyStep * away : 0;
        if (step !== 0) {
            size.value = size.peek() === 0 && step > 0 ? kMin : limit(size.peek() + step < kMin ? 0 : size.peek() + step);
            event.preventDefault();
        } else if (event.key === "Enter") {
            size.value = size.peek() === 0 ? 280 : 0;
            event.preventDefault();
        }
    };
    return (
        <div
            class={horizontal ? "splitter horizontal" : "splitter"}
            role="separator"
            tabIndex={0}
            aria-label={label}
            aria-orientation={horizontal ? "horizontal" : "vertical"}
            aria-controls={controls}
            aria-valuenow={now}
            aria-valuemin={0}
            aria-valuemax={kMax}
            onPointerDown={drag}
            onKeyDown={key}
            onDblClick={() => {
                size.value = size.peek() === 0 ? 280 : 0;
            }}
        />
    );
}

type Folding = "" | "open" | "folded"; // choice of the user; empty: automatic

const kFoldings = new Map<string, Signal<Folding>>();

function foldingOf(id: string): Signal<Folding> {
    const folding = kFoldings.get(id) ?? setting<Folding>(`panel.${id}`, "", ["", "open", "folded"]);
    kFoldings.set(id, folding);
    return folding;
}

/** A panel with a title that folds it. A choice that differs from the automatic state is kept. */
function Section({ studio, panel }: { studio: Studio; panel: Panel }): VNode {
    const { id, title } = panel;
    const folding = foldingOf(id);
    const chosen = useValue(folding);
    const suits = useValue(useMemo(() => computed(() => panel.suits?.(studio) ?? true), [id]));
    const isOpen = chosen === "" ? suits : chosen === "open";
    return (
        <section class="panel" aria-labelledby={`title-${id}`}>
            <h2 class="panel-title" id={`title-${id}`}>
                <button
                    type="button"
                    aria-expanded={isOpen}
                    aria-controls={`body-${id}`}
                    onClick={() => {
                        folding.value = !isOpen === suits ? "" : isOpen ? "folded" : "open";
                        if (!isOpen) {
                            reveal(id);
                        }
                    }}
                >
                    {title}
                </button>
            </h2>
            <div class="panel-body" id={`body-${id}`} hidden={!isOpen}>
                {isOpen && panel.render(studio)}
            </div>
        </section>
    );
}

/** Shows a panel at the side of the view. */
export function showPanel(id: string): void {
    foldingOf(id).value = "open";
    reveal(id);
}

// The column may be longer than the window: an unfolded panel at its end would be below the visible range.
function reveal(id: string): void {
    requestAnimationFrame(() => document.getElementById(`title-${id}`)?.closest(".panel")?.scrollIntoView({ block: "nearest" }));
}

interface SideProps {
    studio: Studio;
    side: "left" | "right";
    panels: Panel[];
    children?: ComponentChildren;
}

const kWidths = { left: setting("width.left", 280), right: setting("width.right", 300) };

export function SidePanels({ studio, side, panels, children }: SideProps): VNode {
    const size = kWidths[side];
    const width = useValue(size);
    const bar = <Splitter label={`Width of the panels on the ${side}`} size={size} away={side === "left" ? 1 : -1} controls={`side-${side}`} />;
    const style = { width: `${width}px` };
    const column = (
        <section class={`side ${side}`} id={`side-${side}`} style={style} hidden={width === 0} aria-label={`Panels on the ${side}`}>
            {children}
            {panels.map((panel) => (
                <Section key={panel.id} studio={studio} panel={panel} />
            ))}
        </section>
    );
    return side === "left" ? (
        <>
            {column}
            {bar}
        </>
    ) : (
        <>
            {bar}
            {column}
        </>
    );
}

const kHeight = setting("height.bottom", 220);
const kTab = setting<string>("tab.bottom", "");

/** Shows a panel below the view. */
export function showBottom(id: string): void {
    kTab.value = id;
    if (kHeight.peek() === 0) {
        kHeight.value = 280;
    }
}

function TabList({ panels, chosen }: { panels: Panel[]; chosen: string }): VNode {
    const go = (event: KeyboardEvent, at: number) => {
        const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
        if (step !== 0) {
            const next = panels[(at + step + panels.length) % panels.length];
            kTab.value = next.id;
            document.getElementById(`tab-${next.id}`)?.focus();
        }
    };
    return (
        <div class="tabs" role="tablist" aria-label="Panels below the view">
            {panels.map((panel, at) => (
                <button
                    key={panel.id}
                    type="button"
                    role="tab"
                    id={`tab-${panel.id}`}
                    aria-selected={panel.id === chosen}
                    aria-controls="bottom-body"
                    tabIndex={panel.id === chosen ? 0 : -1}
                    onClick={() => {
                        kTab.value = panel.id;
                    }}
                    onKeyDown={(event) => go(event, at)}
                >
                    {panel.title}
                </button>
            ))}
        </div>
    );
}

export function BottomPanels({ studio, panels }: { studio: Studio; panels: Panel[] }): VNode | null {
    const height = useValue(kHeight);
    const tab = useValue(kTab);
    const chosen = panels.find((panel) => panel.id === tab) ?? panels[0];
    if (!chosen) {
        return null;
    }
    return (
        <>
            <Splitter label="Height of the panels below the view" size={kHeight} away={-1} horizontal controls="bottom" />
            <div class="bottom" id="bottom" style={{ height: `${height}px` }} hidden={height === 0}>
                <TabList panels={panels} chosen={chosen.id} />
                <div class="bottom-body" id="bottom-body" role="tabpanel" aria-labelledby={`tab-${chosen.id}`} key={chosen.id}>
                    {chosen.render(studio)}
                </div>
            </div>
        </>
    );
}
