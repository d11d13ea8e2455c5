import type { Panel } from "../../app";
import { AnimationPanel } from "./animation/panel";

export const filesPanels: Panel[] = [{ id: "animation", title: "Animation", side: "bottom", order: 40, render: (app) => <AnimationPanel app={app} /> }];
