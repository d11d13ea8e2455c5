import type { Panel } from "../../app";
import "./grow.css";
import { growthModel } from "./model";
import { Steps } from "./steps";

export const growPanels: Panel[] = [
    {
        id: "grow",
        title: "Growth",
        side: "right",
        order: 8,
        suits: (app) => app.store.selection.value.object?.kind !== "mesh",
        render: (app) => <Steps model={growthModel(app)} />,
    },
];
