// Forms for the statements that created the selected object; changes are written into the text of the scene.
import { computed, effect, type ReadonlySignal, signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useMemo } from "preact/hooks";
import type { App } from "../../../app";
import type { ObjectName } from "../../../protocol";
import { placesIn, stepsOf } from "../../../script/names";
import { type Call, readCall } from "../../../script/values";
import { Tracked, useValue } from "../../../use";
import { editorOf } from "../editor/session";
import { fieldContext } from "./context";
import { Fields, initialFields } from "./fields";
import { Form } from "./form";

interface Steps {
    object: ObjectName;
    numbers: readonly number[]; // numbers of the statements in ascending order
}

class Parameters {
    readonly form: Form;
    readonly chosen = signal(0); // number of steps before the last one
    readonly steps: ReadonlySignal<Steps | null>;

    constructor(private readonly app: App) {
        this.form = new Form(app);
        const { store } = app;
        this.steps = computed(() => {
            const { object } = store.selection.value;
            const { statements, objects } = store.state.value;
            const found = object && objects.find(({ kind, name }) => kind === object.kind && name === object.name);
            return found ? { object: found, numbers: stepsOf(store.schema.value, statements, found, found.statement) } : null;
        });
        let before = "";
        effect(() => {
            const { object } = store.selection.value;
            const now = object ? `${object.kind} ${object.name}` : "";
            if (now !== before) {
                before = now;
                this.chosen.value = 0;
            }
        });
        effect(() => this.follow());
    }

    /** The number of the statement in the form. */
    get statement(): number | undefined {
        const numbers = this.steps.value?.numbers ?? [];
        return numbers[Math.max(numbers.length - 1 - this.chosen.value, 0)];
    }

    private follow(): void {
        const steps = this.steps.value;
        const number = this.statement;
        const { statements } = this.app.store.state.value;
        if (this.form.busy.value) {
            return;
        }
        const place = this.form.place.peek();
        const text = number === undefined ? undefined : statements[number]?.text;
        if (!steps || number === undefined || text === undefined) {
            this.form.begin(null);
            return;
        }
        if (place?.statement === number && place.text === text && this.form.command.peek()) {
            return;
        }
        const call = readCall(this.app.store.schema.peek(), text);
        if (call) {
            const { kind, name } = steps.object;
            this.form.change(call, { statement: number, text, comment: call.comment, object: { kind, name }, shows: this.isShown(call, text, steps, number) });
        } else {
            this.form.begin(null);
        }
    }

    // Returns whether the last statement creates the object from other objects; run after the object, it creates the same object
    // again.
    private isShown({ command }: Call, text: string, { object, numbers }: Steps, number: number): boolean {
        const makes = command.arguments.some(({ type }) => type === "new_name");
        const uses = placesIn(this.app.store.schema.peek(), text).some(({ role, name }) => role === "uses" && name === object.name);
        return makes && !uses && number === numbers.at(-1);
    }
}

const kAll = new WeakMap<App, Parameters>();

function parametersOf(app: App): Parameters {
    const known = kAll.get(app) ?? new Parameters(app);
    kAll.set(app, known);
    return known;
}

function StepList({ app, parameters }: { app: App; parameters: Parameters }): VNode | null {
    const steps = useValue(parameters.steps);
    const chosen = useValue(parameters.chosen);
    const { statements } = useValue(app.store.state);
    if (!steps || steps.numbers.length < 2) {
        return null;
    }
    const last = steps.numbers.length - 1;
    return (
        <label class="tool-field steps-field">
            <span>Step</span>
            <select
                value={String(last - chosen)}
                onChange={(event) => {
                    parameters.chosen.value = last - Number(event.currentTarget.value);
                }}
            >
                {steps.numbers.map((number, i) => (
                    <option key={number} value={String(i)}>{`${i + 1}. ${statements[number]?.text.split("\n", 1)[0] ?? ""}`}</option>
                ))}
            </select>
        </label>
    );
}

/** Errors of later statements that conflict with the change. */
function Broken({ app, form }: { app: App; form: Form }): VNode | null {
    const broken = useValue(form.broken);
    return broken ? (
        <div class="error" role="alert">
            <p>{`Later statements do not work with this change. ${broken}`}</p>
            <button type="button" onClick={() => app.command("undo")}>
                Undo the change
            </button>
        </div>
    ) : null;
}

function StatementForm({ app, parameters }: { app: App; parameters: Parameters }): VNode | null {
    const { form } = parameters;
    const command = useValue(form.command);
    const place = useValue(form.place);
    const { statements } = useValue(app.store.state);
    const locked = useValue(app.store.connection) !== "ready";
    const first = useMemo(() => (command ? initialFields(command, form.values.peek()) : []), [command, place?.statement]);
    const number = parameters.statement;
    if (number === undefined || !statements[number]) {
        return null;
    }
    const { line, text } = statements[number];
    const object = parameters.steps.peek()?.object;
    return (
        <>
            <div class="command-title">
                <p>
                    <code>{text.split("\n", 1)[0]}</code>
                </p>
                <button type="button" title="Show it in the text of the scene" onClick={() => object && editorOf(app).goTo(line)}>{`Line ${line}`}</button>
            </div>
            {!command && <p class="hint">It is made by a block or by a line of the language; change that in the scene's text.</p>}
            {command && place && (
                <fieldset class="plain" disabled={locked} aria-label={`Parameters of ${place.object.name}`}>
                    <Tracked
                        draw={() => (
                            <>
                                <Fields
                                    command={command}
                                    first={first}
                                    context={fieldContext(app, form.values.value, (name, words, done) => form.set(name, words, done))}
                                />
                                {/* In Chromium, an empty text node here, in a fieldset, would end the drag of a slider. */}
                                {form.errorText.value !== "" ? (
                                    <p class="error" role="alert">
                                        {form.errorText.value}
                                    </p>
                                ) : null}
                            </>
                        )}
                    />
                    <Broken app={app} form={form} />
                </fieldset>
            )}
        </>
    );
}

export function ParametersPanel({ app }: { app: App }): VNode {
    const parameters = parametersOf(app);
    const steps = useValue(parameters.steps);
    if (!steps) {
        return <p class="hint">Select an object to change how it was created.</p>;
    }
    const key = (event: KeyboardEvent) => {
        if (event.key === "Escape") {
            parameters.form.cancel();
        }
    };
    return (
        <div class="command-form" onKeyDown={key}>
            <h3>{`${steps.object.kind} ${steps.object.name}`}</h3>
            <StepList app={app} parameters={parameters} />
            <StatementForm app={app} parameters={parameters} />
        </div>
    );
}
