// File commands of the page, and the container of their dialogs.
import { effect } from "@preact/signals-core";
import type { VNode } from "preact";
import { useEffect } from "preact/hooks";
import { showBottom } from "../../layout/columns";
import type { Studio } from "../../studio";
import { Dialogs } from "./dialog";
import { exportObjects } from "./export";
import "./files.css";
import { chooseFiles, DropZone, importNamed } from "./import";
import { makePicture } from "./picture";
import { newScene, openScene, saveScene, saveSceneAs } from "./scenes";

const kCommands: Record<string, (studio: Studio) => Promise<void>> = {
    new: newScene,
    open: openScene,
    save: saveScene,
    "save-as": saveSceneAs,
    import: async (studio) => chooseFiles(studio),
    export: exportObjects,
    picture: makePicture,
    animation: async () => showBottom("animation"),
};

/** Imports the file with which the studio was started, after the document has been loaded. */
function useFirstFile(studio: Studio): void {
    useEffect(() => {
        let begun = studio.firstFile === "";
        return effect(() => {
            const { connection, schema } = studio.store;
            if (connection.value === "ready" && schema.value.length > 0 && !begun) {
                begun = true;
                importNamed(studio, studio.firstFile).catch((error: Error) => studio.store.notify(error.message, "error"));
            }
        });
    }, []);
}

export function FileWork({ studio }: { studio: Studio }): VNode {
    useEffect(() => {
        for (const [id, run] of Object.entries(kCommands)) {
            studio.menuCommand(id, () => {
                run(studio).catch((error: Error) => studio.store.notify(error.message, "error"));
            });
        }
    }, []);
    useFirstFile(studio);
    return (
        <>
            <DropZone app={studio} />
            <Dialogs />
        </>
    );
}
