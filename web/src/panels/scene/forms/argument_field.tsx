// Field for one argument of a command: its label, its help and a widget for its type.
import type { ComponentChildren, VNode } from "preact";
import { useId, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Argument } from "../../../protocol";
import { FieldError, useNumber } from "../../../number_field";
import { defaultText, kindsOf, shortUnit, displayName, acceptedValues } from "../../../script/commands";
import { defaultWord, wordOf } from "../../../script/values";
import { isComputed } from "../../../script/words";
import { type Slider, sliderOf } from "../../grow/suggest";
import { type FieldProps, inputAttributes, isGiven, limitsOf, type ArgumentProps, stepOf } from "./field";
import { ListField, PickList } from "./list_field";
import { TupleField } from "./tuple_field";

/** Help of the argument, and the values that it accepts. */
function helpText(argument: Argument): string {
    const bounded = argument.low !== undefined && ["number", "whole", "tuple"].includes(argument.type);
    const range = bounded || argument.type === "selection" ? ` Accepts ${acceptedValues(argument)}.` : "";
    const otherwise = argument.default?.startsWith("@") ? ` Default: ${defaultText(argument)}.` : "";
    return argument.help + range + otherwise;
}

const kTurn = 180; // [degree] half a turn
const kMaxEven = 360; // wider symmetric ranges are shown as numbers only

/** Range of a slider where one is useful: angles within half a turn in both directions. */
function sliderFor(argument: Argument, usual: number): Slider | null {
    const { low = 0, high = 0, unit } = argument;
    const range = unit === "degree" ? { ...argument, low: Math.max(low, -kTurn), high: Math.min(high, kTurn) } : argument;
    return low < -1 && unit !== "degree" && high - low > kMaxEven ? null : sliderOf(range, usual);
}

interface SliderProps {
    label: string;
    slider: Slider;
    word: string;
    take(value: number, done: boolean): void;
}

/** The position of the thumb is not set during a drag, because browsers would end the drag. */
function SliderInput({ label, slider, word, take }: SliderProps): VNode {
    const input = useRef<HTMLInputElement>(null);
    const held = useRef(false);
    useLayoutEffect(() => {
        if (input.current && !held.current) {
            input.current.value = String(slider.toStep(Number(word)));
        }
    });
    const move = (event: Event, done: boolean) => {
        held.current = !done;
        take(slider.toValue((event.currentTarget as HTMLInputElement).valueAsNumber), done);
    };
    return (
        <input
            ref={input}
            type="range"
            aria-label={label}
            aria-valuetext={word}
            min={0}
            max={slider.steps}
            onInput={(event) => move(event, false)}
            onChange={(event) => move(event, true)}
        />
    );
}

function NumberField(props: FieldProps): VNode {
    const { argument, context, id } = props;
    const word = wordOf(argument, context.values);
    const [middle, setMiddle] = useState(Number(word) || Number(argument.default) || 1); // does not change while the slider is dragged
    const slider = sliderFor(argument, context.usual?.(argument.name) ?? middle);
    const take = (value: number, done: boolean) => {
        context.set(argument.name, [String(value)], done);
        if (done && value !== 0 && Math.abs(Math.log10(Math.abs(value / middle))) > 1) {
            setMiddle(Math.abs(value));
        }
    };
    const { field, errorText } = useNumber({
        value: word === "" ? null : Number(word),
        shown: word,
        ...limitsOf(argument),
        step: stepOf(argument, Number(word)),
        take,
        clear: () => context.set(argument.name, [], true), // restores the default
    });
    return (
        <>
            {slider && <SliderInput label={`${displayName(argument.name)}, slider`} slider={slider} word={word} take={take} />}
            <input
                {...inputAttributes(props)}
                {...field}
                id={id}
                class={`${slider ? "" : "wide"} ${isGiven(props) ? "" : "is-default"}`}
                placeholder={argument.required ? "needed" : "none"}
            />
            <FieldError text={errorText} />
        </>
    );
}

function ChoiceField(props: FieldProps & { choices: readonly (readonly [string, string])[] }): VNode {
    const { argument, context, id, choices } = props;
    const word = wordOf(argument, context.values);
    const known = choices.some(([value]) => value === word);
    return (
        <select
            {...inputAttributes(props)}
            id={id}
            class={`wide ${isGiven(props) ? "" : "is-default"}`}
            value={word}
            onChange={(event) => context.set(argument.name, [event.currentTarget.value], true)}
        >
            {!known && <option value={word}>{word === "" ? (argument.required ? "choose…" : "none") : `${word} (does not exist)`}</option>}
            {choices.map(([value, text]) => (
                <option key={value} value={value}>
                    {text}
                </option>
            ))}
        </select>
    );
}

function FlagField(props: FieldProps): VNode {
    const { argument, context, id } = props;
    return (
        <input
            {...inputAttributes(props)}
            id={id}
            type="checkbox"
            checked={/^(?:true|yes|on|1)$/.test(wordOf(argument, context.values))}
            onChange={(event) => context.set(argument.name, [String(event.currentTarget.checked)], true)}
        />
    );
}

function TextField(props: FieldProps): VNode {
    const { argument, context, id } = props;
    const files = argument.type.endsWith("_file") || argument.type === "properties" ? context.files?.() : undefined;
    const take = (event: Event, done: boolean) => context.set(argument.name, [(event.currentTarget as HTMLInputElement).value.trim()], done);
    return (
        <>
            <input
                {...inputAttributes(props)}
                id={id}
                type="text"
                class="wide"
                spellcheck={false}
                autocomplete="off"
                list={files ? `${id}-files` : undefined}
                placeholder={argument.required ? "needed" : defaultWord(argument, context.values) || "none"}
                value={(context.values[argument.name] ?? []).join(" ")}
                onInput={(event) => take(event, false)}
                onChange={(event) => take(event, true)}
            />
            {files && (
                <datalist id={`${id}-files`}>
                    {files.map((name) => (
                        <option key={name} value={name} />
                    ))}
                </datalist>
            )}
        </>
    );
}

/** A selection of nodes: typed, or copied from the 3D view. */
function SelectionField(props: FieldProps): VNode {
    const { argument, context } = props;
    const take = async () => {
        const text = await context.selected?.();
        if (text) {
            context.set(argument.name, [text], true);
        }
    };
    return (
        <>
            <TextField {...props} />
            {context.selected && (
                <button type="button" class="wide" onClick={() => void take()}>
                    Use the selection of the view
                </button>
            )}
        </>
    );
}

function fieldOf(props: FieldProps): VNode {
    const { argument, context } = props;
    const words = context.values[argument.name] ?? [];
    const names = () => context.names(kindsOf(argument));
    if (argument.repeats) {
        return argument.type === "object" ? <PickList {...props} names={names()} /> : <ListField {...props} />;
    }
    if (words.some(isComputed)) {
        return <TextField {...props} />;
    }
    switch (argument.type) {
        case "number":
        case "whole":
            return <NumberField {...props} />;
        case "flag":
            return <FlagField {...props} />;
        case "choice":
            return <ChoiceField {...props} choices={(argument.choices ?? []).map((word) => [word, word.replaceAll("_", " ")])} />;
        case "object": {
            const none = argument.required ? [] : [["", "none"] as const];
            return <ChoiceField {...props} choices={[...none, ...names().map((name) => [name, name] as const)]} />;
        }
        case "tuple":
            return <TupleField {...props} />;
        case "selection":
            return <SelectionField {...props} />;
        default:
            return <TextField {...props} />;
    }
}

function Row({ argument, id, children }: { argument: Argument; id: string; children: ComponentChildren }): VNode {
    const unit = argument.unit ? ` [${shortUnit(argument)}]` : "";
    const single = !argument.repeats && argument.type !== "tuple";
    return (
        <div class="argument" title={helpText(argument)}>
            {single ? (
                <label for={id}>{displayName(argument.name) + unit}</label>
            ) : (
                <span class="argument-label" id={`${id}-label`}>
                    {displayName(argument.name) + unit}
                </span>
            )}
            {children}
            <p class="hint" id={`${id}-help`}>
                {helpText(argument)}
            </p>
        </div>
    );
}

export function ArgumentField({ argument, context }: ArgumentProps): VNode {
    const id = useId();
    return (
        <div onFocusIn={() => context.focus?.(argument.name)} onFocusOut={() => context.focus?.(null)}>
            <Row argument={argument} id={id}>
                {fieldOf({ argument, context, id })}
            </Row>
        </div>
    );
}
