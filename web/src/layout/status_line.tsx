// Status of the tool, object under the pointer, progress of a command.
import type { VNode } from "preact";
import type { Studio } from "../studio";
import { Tracked, useValue } from "../use";

function Progress({ studio }: { studio: Studio }): VNode | null {
    const { running, doing } = useValue(studio.store.state);
    const progress = useValue(studio.store.progress);
    if (running === null) {
        return null;
    }
    return (
        <span class="progress">
            <progress aria-label={`Progress of ${doing}`} value={progress?.statement === running ? progress.fraction : undefined} max={1} />
            <code>{doing}</code>
            <button type="button" onClick={() => studio.engine.cancel()}>
                Stop
            </button>
        </span>
    );
}

function Hover({ studio }: { studio: Studio }): VNode {
    const pick = useValue(studio.store.hover);
    const part = pick?.node !== undefined ? `, node ${pick.node}` : pick?.index !== undefined ? `, point ${pick.index}` : "";
    return <span class="hover">{pick ? `${pick.object.kind} ${pick.object.name}${part}` : ""}</span>;
}

export function StatusLine({ studio }: { studio: Studio }): VNode {
    const { error } = useValue(studio.store.state);
    return (
        <footer class="status">
            <span class="status-text" role="status">
                {error ? (
                    <span class="error">{`Line ${error.line}: ${error.message}`}</span>
                ) : (
                    <Tracked
                        draw={() => {
                            void studio.activeTool.eventCount.value;
                            return studio.activeTool.run.value?.status?.() ?? "";
                        }}
                    />
                )}
            </span>
            <Progress studio={studio} />
            <Hover studio={studio} />
        </footer>
    );
}
