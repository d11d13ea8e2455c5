// The fields of a card: the most important ones, and all others below.
import type { ComponentChildren, VNode } from "preact";
import type { Argument } from "../../protocol";
import { Tracked, tracked } from "../../use";
import { ArgumentField } from "../scene/forms/argument_field";
import { fieldContext } from "../scene/forms/context";
import type { FieldContext } from "../scene/forms/field";
import type { Card } from "./card";
import { numberOf } from "./values";

interface Props {
    card: Card;
    main: readonly string[]; // arguments that are shown at once
    focus?(name: string | null): void;
}

/** The seed of random numbers, with buttons for a random and the next one. */
const Seed = tracked(({ card }: { card: Card }) => {
    const argument = card.arguments.find(({ name }) => name === "seed");
    if (!argument) {
        return null;
    }
    const still = card.command.value === "grow" && card.schema && numberOf(card.schema, card.values.value, "jitter") === 0;
    const now = Number(card.values.value.seed?.[0] ?? 0) || 0;
    const set = (seed: number) => card.set("seed", [String(seed)], true);
    return (
        <div class="tool-row seed">
            {still && <p class="hint">There is no randomness while the jitter is 0.</p>}
            <button type="button" aria-label="Random seed" title="Random seed" onClick={() => set(1 + Math.floor(Math.random() * 9999))}>
                <span aria-hidden="true">⚄</span> Seed
            </button>
            <button type="button" onClick={() => set(now + 1)}>
                Next seed
            </button>
        </div>
    );
});

export function contextOf(card: Card, focus?: (name: string | null) => void): FieldContext {
    return {
        ...fieldContext(card.app, card.values.value, (name, words, done) => card.set(name, words, done)),
        usual: (name) => card.usual(name),
        focus,
    };
}

const Fields = tracked(({ card, main, focus }: Props) => {
    const context = contextOf(card, focus);
    const field = (argument: Argument) => <ArgumentField key={`${card.command.value}.${argument.name}`} argument={argument} context={context} />;
    const first = main.flatMap((name) => card.arguments.find((argument) => argument.name === name) ?? []);
    const isNamed = card.bound.value !== null; // other lines use this name
    const rest = card.arguments.filter((argument) => !first.includes(argument) && !(isNamed && argument.type === "new_name"));
    return (
        <>
            {first.map(field)}
            <Seed card={card} />
            {rest.length > 0 && (
                <details class="all-options">
                    <summary>All options</summary>
                    {rest.map(field)}
                </details>
            )}
        </>
    );
});

/** Describes the changed statement or the new object, and shows the error of the engine. */
export const CardState = tracked(({ card }: { card: Card }) => {
    const bound = card.bound.value;
    const { statements, error } = card.app.store.state.value;
    return (
        <>
            {bound && (
                <p class="standing">
                    <span>{`Changes line ${statements[bound.statement]?.line ?? bound.statement + 1}, ${card.target?.name ?? ""}.`}</span>
                    <button type="button" onClick={() => card.renew()}>
                        Make another
                    </button>
                </p>
            )}
            {card.errorText.value && (
                <p class="error" role="alert">
                    {card.errorText.value}
                </p>
            )}
            {bound && error && error.statement > bound.statement && (
                <div class="error" role="alert">
                    <p>{`Later statements do not work with this change. Line ${error.line}: ${error.message}`}</p>
                    <p class="hint">No data is lost: change that line in the scene, or undo this change.</p>
                    <button type="button" onClick={() => card.app.command("undo")}>
                        Undo the change
                    </button>
                </div>
            )}
        </>
    );
});

export function CommandCard({ card, main, focus, children }: Props & { children?: ComponentChildren }): VNode {
    const left = (event: FocusEvent) => {
        const isInside = event.relatedTarget instanceof Node && (event.currentTarget as Node).contains(event.relatedTarget);
        const looks = event.relatedTarget === null || event.relatedTarget === card.app.view.element(); // the user may rotate the view
        if (!isInside && !looks && !card.busy.peek()) {
            card.endPreview();
        }
    };
    const key = (event: KeyboardEvent) => {
        if (event.key === "Escape") {
            card.reread();
            event.preventDefault();
        }
    };
    return (
        <div class="command-card" onFocusOut={left} onKeyDown={key}>
            <CardState card={card} />
            {children}
            <Fields card={card} main={main} focus={focus} />
            <Tracked
                draw={() => (
                    <code class="line" title="The line of this command">
                        {card.missing ? "" : card.line}
                    </code>
                )}
            />
        </div>
    );
}
