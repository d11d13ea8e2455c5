// A selection from the objects of the scene.
import type { VNode } from "preact";
import type { ObjectName } from "../../protocol";
import { keyOf } from "../../view/object_view";

interface Props {
    all: readonly ObjectName[];
    chosen: readonly ObjectName[];
    set(chosen: readonly ObjectName[]): void;
}

export function ObjectChecks({ all, chosen, set }: Props): VNode {
    return (
        <fieldset class="file-objects">
            <legend>Objects</legend>
            {all.map(({ kind, name }) => {
                const key = keyOf({ kind, name });
                const without = chosen.filter((one) => keyOf(one) !== key);
                const isChosen = without.length < chosen.length;
                return (
                    <label key={key} class="file-check">
                        <input type="checkbox" checked={isChosen} onChange={() => set(isChosen ? without : [...chosen, { kind, name }])} />
                        <span>
                            {name} <span class="hint">{kind}</span>
                        </span>
                    </label>
                );
            })}
        </fieldset>
    );
}
