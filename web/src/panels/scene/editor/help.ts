// Help from the schema for the word at a position of a line.
import { type Extension } from "@codemirror/state";
import { type EditorView, hoverTooltip, type Tooltip } from "@codemirror/view";
import type { Argument, Command } from "../../../protocol";
import { bind, defaultText, findCommand, kLanguage, acceptedValues, usage } from "../../../script/commands";
import { readLine } from "../../../script/words";

export interface Help {
    title: string; // "sphere NAME [OPTION=VALUE...]", "radius="
    text: string;
    from: number; // range of the word
    to: number;
}

/** Title and text of an argument. */
export function argumentHelp(argument: Argument): { title: string; text: string } {
    const title = argument.positional ? argument.name.toUpperCase() : `${argument.name}=`;
    const otherwise = defaultText(argument) ? ` Default: ${defaultText(argument)}.` : "";
    return { title, text: `${argument.help} Accepts ${acceptedValues(argument)}.${otherwise}` };
}

export function commandHelp(command: Command): { title: string; text: string } {
    return { title: usage(command), text: command.help };
}

/** Help for a position in a line: for the argument there, otherwise for the command. */
export function helpAt(schema: readonly Command[], line: string, column: number): Help | null {
    const { words, comment } = readLine(line);
    const [first] = words;
    if (!first || column > comment) {
        return null;
    }
    const statement = kLanguage.find(({ name }) => name === first.text);
    if (statement) {
        return { title: statement.usage, text: statement.help, from: first.from, to: first.to };
    }
    const found = findCommand(schema, words);
    if (!found) {
        return null;
    }
    const { bound } = bind(found.command, words.slice(found.used));
    for (const { argument, words: mine } of bound) {
        const from = mine[0].from;
        const { to } = mine[mine.length - 1];
        if (column >= from && column <= to) {
            return { ...argumentHelp(argument), from, to };
        }
    }
    return { ...commandHelp(found.command), from: first.from, to: words[found.used - 1].to };
}

function tooltip(view: EditorView, schema: readonly Command[], pos: number): Tooltip | null {
    const line = view.state.doc.lineAt(pos);
    const help = helpAt(schema, line.text, pos - line.from);
    if (!help || pos < line.from + help.from || pos > line.from + help.to) {
        return null;
    }
    return {
        pos: line.from + help.from,
        end: line.from + help.to,
        above: true,
        create: () => {
            const dom = document.createElement("div");
            dom.className = "scene-help";
            const title = dom.appendChild(document.createElement("code"));
            title.textContent = help.title;
            dom.appendChild(document.createElement("p")).textContent = help.text;
            return { dom };
        },
    };
}

export function helpOnHover(schema: () => readonly Command[]): Extension {
    return hoverTooltip((view, pos) => tooltip(view, schema(), pos));
}
