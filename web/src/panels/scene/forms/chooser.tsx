// List of the commands by group, with a search field.
import type { VNode } from "preact";
import { useId, useState } from "preact/hooks";
import type { Command } from "../../../protocol";

/**
 * Commands that match a search: first those with this name or prefix, then matches within names, then matches within help texts.
 */
export function searched(schema: readonly Command[], search: string): Command[] {
    const wanted = search.trim().toLowerCase();
    const words = wanted.split(/\s+/);
    const kNone = 4;
    const rank = ({ name, aliases, help, group }: Command) => {
        const names = [name, ...aliases].map((one) => one.toLowerCase());
        const all = `${names.join(" ")} ${help} ${group}`.toLowerCase();
        const ranks = [
            names.includes(wanted),
            names.some((one) => one.startsWith(wanted)),
            words.every((word) => names.join(" ").includes(word)),
            words.every((word) => all.includes(word)),
        ];
        return ranks.includes(true) ? ranks.indexOf(true) : kNone;
    };
    return wanted === "" ? [...schema] : schema.filter((one) => rank(one) < kNone).sort((a, b) => rank(a) - rank(b));
}

function grouped(commands: readonly Command[]): [string, Command[]][] {
    const groups = new Map<string, Command[]>();
    for (const command of commands) {
        groups.set(command.group, [...(groups.get(command.group) ?? []), command]);
    }
    return [...groups];
}

interface Props {
    schema: readonly Command[];
    choose(command: Command): void;
}

export function Chooser({ schema, choose }: Props): VNode {
    const id = useId();
    const [search, setSearch] = useState("");
    const [active, setActive] = useState(0);
    const groups = grouped(searched(schema, search));
    const found = groups.flatMap(([, commands]) => commands);
    const idOf = (command: Command | undefined) => (command ? `${id}-${schema.indexOf(command)}` : undefined);
    const go = (to: number) => {
        const at = Math.min(Math.max(to, 0), found.length - 1);
        setActive(at);
        document.getElementById(idOf(found[at]) ?? "")?.scrollIntoView({ block: "nearest" });
    };
    const key = (event: KeyboardEvent) => {
        const steps: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 };
        if (event.key in steps) {
            go(active + steps[event.key]);
        } else if (event.key === "Enter" && found[active]) {
            choose(found[active]);
        } else {
            return;
        }
        event.preventDefault();
    };
    return (
        <div class="command-chooser">
            <input
                role="combobox"
                list={undefined}
                aria-label="Search commands"
                aria-expanded="true"
                aria-controls={`${id}-list`}
                aria-activedescendant={idOf(found[active])}
                aria-autocomplete="list"
                placeholder="Search commands…"
                autocomplete="off"
                spellcheck={false}
                value={search}
                onInput={(event) => {
                    setSearch(event.currentTarget.value);
                    setActive(0);
                }}
                onKeyDown={key}
            />
            <div class="command-list" id={`${id}-list`} role="listbox" aria-label="Commands" tabIndex={-1}>
                {groups.map(([group, commands]) => (
                    <div key={group} role="group" aria-label={group}>
                        <span class="command-group" aria-hidden="true">
                            {group}
                        </span>
                        {commands.map((command) => (
                            <div
                                key={command.name}
                                id={idOf(command)}
                                role="option"
                                aria-selected={command === found[active]}
                                class="command-option"
                                onClick={() => choose(command)}
                            >
                                <b>{command.name}</b> <span class="hint">{command.help}</span>
                            </div>
                        ))}
                    </div>
                ))}
                {found.length === 0 && <p class="hint">No command has this name or help text.</p>}
            </div>
        </div>
    );
}
