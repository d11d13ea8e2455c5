// Which command a line is, and which of its arguments each word is: as the engine binds them.
import type { Argument, Command, Kind } from "../protocol";
import type { Word } from "./words";

/** Lines of the language itself, which the schema does not have. */
export const kLanguage: readonly { name: string; usage: string; help: string }[] = [
    { name: "let", usage: "let NAME = EXPRESSION", help: "gives a variable a value, which ${NAME} puts into the lines after it" },
    { name: "for", usage: "for NAME in FIRST..LAST [step STEP]", help: "runs the lines down to its end for each number" },
    { name: "repeat", usage: "repeat COUNT", help: "runs the lines down to its end so many times" },
    { name: "if", usage: "if CONDITION", help: "runs the lines down to its else or end where the condition is not 0" },
    { name: "else", usage: "else", help: "begins what runs where the condition of the if above is 0" },
    { name: "end", usage: "end", help: "closes the for, repeat or if above" },
];

/** The command that words begin with, and how many of them are its name. */
export function findCommand(schema: readonly Command[], words: readonly Word[]): { command: Command; used: number } | null {
    const called = (name: string) => schema.find((command) => command.name === name || command.aliases.includes(name));
    const [first, second] = words;
    if (!first || first.key !== "") {
        return null;
    }
    const both = second?.key === "" ? called(`${first.text} ${second.text}`) : undefined;
    if (both) {
        return { command: both, used: 2 };
    }
    const one = called(first.text);
    return one ? { command: one, used: 1 } : null;
}

export interface Bound {
    argument: Argument;
    words: Word[]; // one; several where a point stands as one word for each number
}

const kNumber = /^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?$/;

/** How many numbers a word holds; 0 where it is none. */
export function numbersIn(text: string): number {
    const parts = text.split(",");
    return parts.every((part) => kNumber.test(part)) ? parts.length : text.includes("${") ? 1 : 0;
}

function pointLength(argument: Argument, words: readonly Word[]): number {
    const most = Math.max(...(argument.sizes ?? [1]));
    let numbers = 0;
    let count = 0;
    for (; count < words.length && numbers < most; ++count) {
        const more = numbersIn(words[count].text);
        if (more === 0) {
            break;
        }
        numbers += more;
    }
    return Math.max(count, 1);
}

/** Gives the words behind a command's name to its arguments. `unknown` are those that fit none. */
export function bind(command: Command, words: readonly Word[]): { bound: Bound[]; unknown: Word[] } {
    const bound: Bound[] = [];
    const unknown: Word[] = [];
    for (const word of words.filter(({ key }) => key !== "")) {
        const argument = command.arguments.find(({ name }) => name === word.key);
        if (argument) {
            bound.push({ argument, words: [word] });
        } else {
            unknown.push(word);
        }
    }
    const named = new Set(bound.map(({ argument }) => argument));
    const order = command.arguments.filter((argument) => argument.positional && !named.has(argument));
    const plain = words.filter(({ key }) => key === "");
    let at = 0;
    order.forEach((argument, i) => {
        const left = plain.length - at;
        if (left === 0) {
            return;
        }
        if (argument.repeats) {
            const mine = Math.max(left - (order.length - i - 1), 0);
            plain.slice(at, at + mine).forEach((word) => bound.push({ argument, words: [word] }));
            at += mine;
        } else {
            const mine = argument.type === "tuple" ? pointLength(argument, plain.slice(at)) : 1;
            bound.push({ argument, words: plain.slice(at, at + mine) });
            at += mine;
        }
    });
    return { bound, unknown: [...unknown, ...plain.slice(at)] };
}

const kKinds: readonly Kind[] = ["solid", "path", "profile", "points", "skeleton", "mesh"];

/** The kinds of objects that an argument takes, the likeliest first. */
export function kindsOf(argument: Argument): readonly Kind[] {
    if (argument.type === "section") {
        return ["profile"];
    }
    if (argument.type !== "object") {
        return [];
    }
    const { kind } = argument;
    return kind && kKinds.includes(kind) ? [kind, ...(argument.also ?? [])] : kKinds;
}

/** What people call an argument: "branching angle". */
export function spoken(name: string): string {
    const words = name.replaceAll("_", " ");
    return words.charAt(0).toUpperCase() + words.slice(1);
}

const kUnits: Record<string, string> = { metre: "m", degree: "°", radius: "radii", second: "s" };

/** The unit as it stands behind a number. */
export function shortUnit(argument: Argument): string {
    return argument.unit ? (kUnits[argument.unit] ?? argument.unit) : "";
}

function numberText(value: number): string {
    return String(Number(value.toPrecision(4)));
}

/** What an argument takes, in short: "number of m from 0 to 10, else 1". */
export function takes(argument: Argument): string {
    const range = argument.low !== undefined && argument.high !== undefined
        ? ` from ${numberText(argument.low)} to ${numberText(argument.high)}`
        : "";
    const unit = argument.unit ? ` [${shortUnit(argument)}]` : "";
    const what: Record<Argument["type"], string> = {
        new_name: "a new name",
        object: `the name of ${kindsOf(argument).length > 2 ? "an object" : kindsOf(argument).join(" or ")}`,
        number: `a number${unit}${range}`,
        whole: `a whole number${range}`,
        flag: "true or false",
        choice: (argument.choices ?? []).join(", "),
        tuple: `${(argument.sizes ?? []).join(" or ")} numbers${unit} joined by commas`,
        section: "PROFILE@FRACTION",
        word: "a word",
        input_file: "a file to read",
        selection: "nodes, such as 12, subtree(12) or tips&!order(0)",
        output_file: "a file to write",
        properties: "a file of options",
    };
    return what[argument.type] + (argument.repeats ? "; may stand several times" : "");
}

/** What an argument is where it is not given: "1", "that of solid"; empty where there is no such thing. */
export function defaultText(argument: Argument): string {
    return argument.default?.startsWith("@") ? `that of ${argument.default.slice(1)}` : (argument.default ?? "");
}

/** "mesh TREE [NAME] [OPTION=VALUE...]" */
export function usage(command: Command): string {
    const words = command.arguments
        .filter(({ positional }) => positional)
        .map(({ name, repeats, required }) => {
            const word = name.toUpperCase() + (repeats ? "..." : "");
            return required ? word : `[${word}]`;
        });
    const options = command.arguments.some(({ positional }) => !positional) ? ["[OPTION=VALUE...]"] : [];
    return [command.name, ...words, ...options].join(" ");
}
