// Progress of a request that does not belong to the document.
import type { VNode } from "preact";
import type { App } from "../../app";
import { useValue } from "../../use";

export function RequestProgress({ app, label }: { app: App; label: string }): VNode {
    const progress = useValue(app.store.progress);
    const fraction = progress?.statement === null ? progress.fraction : undefined;
    return (
        <p class="request-progress">
            <progress aria-label={label} value={fraction} max={1} />
            <span>{fraction === undefined ? `${label}…` : `${label}: ${Math.round(fraction * 100)} %`}</span>
        </p>
    );
}
