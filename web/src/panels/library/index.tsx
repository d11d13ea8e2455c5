import type { Panel } from "../../app";
import "./library.css";
import { libraryModel } from "./model";
import { CompositionPanel, LibraryPanel } from "./panel";

export const libraryPanels: Panel[] = [
    { id: "library", title: "Library", side: "right", order: 20, suits: () => false, render: (app) => <LibraryPanel model={libraryModel(app)} /> },
    { id: "compose", title: "Composition", side: "right", order: 21, suits: () => false, render: (app) => <CompositionPanel model={libraryModel(app)} /> },
];
