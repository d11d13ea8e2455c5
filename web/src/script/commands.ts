// Finds the command of a line and the argument of each word, with the rules of the engine.
import type { Argument, Command, Kind } from "../protocol";
import type { Word } from "./words";

/** Statements of the language itself, which are not in the schema. */
export const kLanguage: readonly { name: string; usage: string; help: string }[] = [
    { name: "let", usage: "let NAME = EXPRESSION", help: "Set a variable, which ${NAME} inserts into the following lines." },
    {
        name: "for",
        usage: "for NAME in FIRST..LAST [step STEP]",
        help: "Run the lines up to the end for each number from the first to the last, which is stored in a variable.",
    },
    { name: "repeat", usage: "repeat COUNT", help: "Run the lines up to the end a number of times." },
    { name: "if", usage: "if CONDITION", help: "Run the lines up to the else or end if the condition is not 0." },
    { name: "else", usage: "else", help: "Begin the lines that run if the condition of the if above is 0." },
    { name: "end", usage: "end", help: "Close the for, repeat or if above." },
];

/** Finds the command at the start of the words, and the number of words in its name. */
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
    words: Word[]; // usually one; several if a point is given as one word for each number
}

const kNumber = /^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?$/;

/** Returns the number of numbers in a word; 0 if it contains other text. */
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

/** Assigns the words after the name of a command to its arguments. `unknown` contains the words that match no argument. */
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

/** All kinds of objects. */
export const kKinds: readonly Kind[] = ["solid", "path", "profile", "points", "skeleton", "mesh", "material"];

/** The kinds of objects that an argument accepts, the most probable first. */
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

/** The name of an argument in plain words: "Branching angle". */
export function displayName(name: string): string {
    const words = name.replaceAll("_", " ");
    return words.charAt(0).toUpperCase() + words.slice(1);
}

const kUnits: Record<string, string> = { metre: "m", degree: "°", radius: "radii", second: "s" };

/** The unit as printed after a number. */
export function shortUnit(argument: Argument): string {
    return argument.unit ? (kUnits[argument.unit] ?? argument.unit) : "";
}

function numberText(value: number): string {
    return String(Number(value.toPrecision(4)));
}

/** Describes the values that an argument accepts: "a number from 0 to 10 [m]". */
export function acceptedValues(argument: Argument): string {
    const range = argument.low !== undefined && argument.high !== undefined ? ` from ${numberText(argument.low)} to ${numberText(argument.high)}` : "";
    const unit = argument.unit ? ` [${shortUnit(argument)}]` : "";
    const descriptions: Record<Argument["type"], string> = {
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
    return descriptions[argument.type] + (argument.repeats ? "; can be repeated" : "");
}

/** Describes the default of an argument: "1", "that of solid"; empty if there is no default. */
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
