// The page: header, panels left and right of the view, panels below it, status line.
import type { VNode } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Panel } from "../app";
import { Notices } from "../panels/scene/index";
import type { Studio } from "../studio";
import "../style/base.css";
import "../style/layout.css";
import { Tracked } from "../use";
import { BottomPanels, SidePanels } from "./columns";
import { Header } from "./header";
import { Parts } from "./parts";
import { ShortcutTable } from "./shortcut_table";
import { StatusLine } from "./status_line";
import { Toasts } from "./toasts";
import { ToolBar, ToolPanel } from "./tool_bar";
import { ViewButtons } from "./view_buttons";

function panelsOf(studio: Studio, side: Panel["side"]): Panel[] {
    return studio.panels.filter((panel) => panel.side === side).sort((a, b) => a.order - b.order);
}

function Picture({ studio }: { studio: Studio }): VNode {
    const holder = useRef<HTMLDivElement>(null);
    useEffect(() => {
        if (holder.current) {
            studio.view.attach(holder.current);
        }
    }, []);
    return (
        <section class="picture" aria-label="3D view">
            <div class="picture-frame">
                <div class="picture-canvas" ref={holder} />
                <ViewButtons studio={studio} />
                <Toasts store={studio.store} />
            </div>
            <ToolBar studio={studio} />
        </section>
    );
}

export function Layout({ studio }: { studio: Studio }): VNode {
    useEffect(() => {
        const parts = new Parts();
        studio.menuCommand("next-part", () => parts.go(1));
        studio.menuCommand("part-before", () => parts.go(-1));
    }, []);
    return (
        <div class="studio">
            <Header studio={studio} />
            <Notices app={studio} />
            <main class="middle">
                <SidePanels studio={studio} side="left" panels={panelsOf(studio, "left")} />
                <div class="centre">
                    <Picture studio={studio} />
                    <BottomPanels studio={studio} panels={panelsOf(studio, "bottom")} />
                </div>
                <SidePanels studio={studio} side="right" panels={panelsOf(studio, "right")}>
                    <Tracked draw={() => <ToolPanel studio={studio} />} />
                </SidePanels>
            </main>
            <StatusLine studio={studio} />
            <ShortcutTable studio={studio} />
        </div>
    );
}
