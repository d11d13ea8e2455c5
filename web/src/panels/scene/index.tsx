// The scene as text, objects, history and forms.
import type { App, Panel } from "../../app";
import { ScenePanel } from "./editor/panel";
import { editorOf } from "./editor/session";
import { CommandPanel } from "./forms/command";
import { ParametersPanel } from "./forms/parameters";
import { HistoryPanel } from "./history/panel";
import { addObjectCommands } from "./objects/actions";
import { ObjectsPanel } from "./objects/panel";
import "./scene.css";

export { Notices } from "./notices";

const kReady = new WeakSet<App>();

function once(app: App): App {
    if (!kReady.has(app)) {
        kReady.add(app);
        addObjectCommands(app);
        app.menuCommand("run-to-cursor", () => void editorOf(app).runTo(editorOf(app).cursorLine));
        app.menuCommand("run-all", () => void editorOf(app).runAll());
    }
    return app;
}

export const scenePanels: Panel[] = [
    { id: "objects", title: "Objects", side: "left", order: 10, render: (app) => <ObjectsPanel app={once(app)} /> },
    {
        id: "parameters",
        title: "Parameters",
        side: "left",
        order: 20,
        suits: (app) => app.store.selection.value.object !== null,
        render: (app) => <ParametersPanel app={app} />,
    },
    { id: "history", title: "History", side: "left", order: 90, render: (app) => <HistoryPanel app={app} /> },
    { id: "command", title: "Command", side: "right", order: 20, suits: () => false, render: (app) => <CommandPanel app={app} /> },
    { id: "scene", title: "Scene", side: "bottom", order: 10, render: (app) => <ScenePanel app={app} /> },
];
