// All tools of the studio, in the order of the toolbar.
import type { Tool } from "../app";
import { sketchTools } from "../sketch/tool";
import { bendTools } from "./branch/bend";
import { cutTools } from "./branch/cut";
import { drawTools } from "./branch/draw";
import { graftTools } from "./branch/graft";
import { pruneTools } from "./branch/prune";
import { radiusTools } from "./branch/radius";
import { shapeTools } from "./branch/shape";
import { combineTools } from "./crown/combine";
import { curveTools } from "./crown/curve";
import { loftTools } from "./crown/loft";
import { placeTools } from "./crown/place";
import { profileTools } from "./crown/profile";
import { warpTools } from "./crown/warp";
import { measureTools } from "./measure";
import { pointTools } from "./points/brush";
import { selectTools } from "./select";
import "./tools.css";
import { transformTools } from "./transform";

export const tools: Tool[] = [
    ...selectTools,
    ...transformTools,
    ...measureTools,
    ...placeTools,
    ...combineTools,
    ...warpTools,
    ...profileTools,
    ...curveTools,
    ...loftTools,
    ...pointTools,
    ...sketchTools,
    ...drawTools,
    ...bendTools,
    ...radiusTools,
    ...pruneTools,
    ...cutTools,
    ...graftTools,
    ...shapeTools,
];
