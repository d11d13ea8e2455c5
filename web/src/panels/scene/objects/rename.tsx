// The dialog for renaming.
import type { VNode } from "preact";
import { useState } from "preact/hooks";
import type { Kind, ObjectName } from "../../../protocol";
import { openDialog, Dialog } from "../../files/dialog";

interface Props {
    object: ObjectName;
    others: readonly Kind[]; // further objects of that name
    check(name: string): string;
    end(name: string | null): void;
}

function RenameDialog({ object, others, check, end }: Props): VNode {
    const [name, setName] = useState(object.name);
    const errorText = check(name);
    return (
        <Dialog
            title={`Rename ${object.kind} ${object.name}`}
            close={() => end(null)}
            accept={() => errorText === "" && name !== "" && end(name)}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={errorText !== "" || name === ""}>
                        Rename
                    </button>
                    <button type="button" onClick={() => end(null)}>
                        Cancel
                    </button>
                </>
            }
        >
            <label class="tool-field">
                <span>Name</span>
                <input
                    type="text"
                    autofocus
                    spellcheck={false}
                    autocomplete="off"
                    aria-invalid={errorText !== "" || undefined}
                    aria-describedby="rename-trouble"
                    value={name}
                    onFocus={(event) => event.currentTarget.select()}
                    onInput={(event) => setName(event.currentTarget.value.trim())}
                />
            </label>
            {others.length > 0 && <p class="hint">{`The ${others.join(" and ")} of that name is renamed with it.`}</p>}
            <p id="rename-trouble" class="error" role="alert">
                {errorText}
            </p>
        </Dialog>
    );
}

/** Asks for a new name of an object; null if the name is kept. */
export function requestName(object: ObjectName, others: readonly Kind[], check: (name: string) => string): Promise<string | null> {
    return openDialog<string>((end) => <RenameDialog object={object} others={others} check={check} end={end} />);
}
