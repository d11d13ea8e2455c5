// The table of keyboard shortcuts.
import type { VNode } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { kShortcuts } from "../keys";
import type { Studio } from "../studio";

export function ShortcutTable({ studio }: { studio: Studio }): VNode {
    const dialog = useRef<HTMLDialogElement>(null);
    useEffect(() => studio.menuCommand("shortcuts", () => dialog.current?.showModal()), []);
    const rows = [...studio.tools.filter((tool) => tool.shortcut).map((tool) => ({ keys: [tool.shortcut ?? ""], label: tool.label })), ...kShortcuts];
    return (
        <dialog class="dialog" ref={dialog} aria-labelledby="shortcuts-title">
            <h2 id="shortcuts-title">Keyboard shortcuts</h2>
            <div class="dialog-body" tabIndex={0} role="region" aria-labelledby="shortcuts-title">
                <table>
                    <thead>
                        <tr>
                            <th scope="col">Keys</th>
                            <th scope="col">Function</th>
                        </tr>
                    </thead>
                    <tbody>
                        {rows.map((row) => (
                            <tr key={row.label}>
                                <td>
                                    {row.keys.map((keys, at) => (
                                        <>
                                            {at > 0 && " or "}
                                            <kbd>{keys}</kbd>
                                        </>
                                    ))}
                                </td>
                                <td>{row.label}</td>
                            </tr>
                        ))}
                    </tbody>
                </table>
            </div>
            <form method="dialog">
                <button type="submit">Close</button>
            </form>
        </dialog>
    );
}
