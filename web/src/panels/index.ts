// All panels of the studio.
import type { Panel } from "../app";
import { displayPanels } from "./display/index";
import { filesPanels } from "./files/index";
import { growPanels } from "./grow/index";
import { libraryPanels } from "./library/index";
import { scenePanels } from "./scene/index";

export const panels: Panel[] = [...scenePanels, ...growPanels, ...libraryPanels, ...displayPanels, ...filesPanels];
