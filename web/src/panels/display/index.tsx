// Display settings of the view, and the check of the surface in it.
import type { App, Panel } from "../../app";
import { CheckPanel } from "./check_panel";
import "./display.css";
import { DisplayPanel } from "./display_panel";

const isOfMesh = (app: App) => app.store.selection.value.object?.kind === "mesh";

export const displayPanels: Panel[] = [
    { id: "display", title: "Display", side: "right", order: 60, suits: isOfMesh, render: (app) => <DisplayPanel app={app} /> },
    { id: "check", title: "Check", side: "right", order: 50, suits: isOfMesh, render: (app) => <CheckPanel app={app} /> },
];
