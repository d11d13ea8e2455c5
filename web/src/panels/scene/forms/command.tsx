// Form for any command of the scene.
import type { VNode } from "preact";
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import type { App } from "../../../app";
import type { Command } from "../../../protocol";
import { usage } from "../../../script/commands";
import { Tracked, useValue } from "../../../use";
import { Chooser } from "./chooser";
import { fieldContext } from "./context";
import { Fields, initialFields } from "./fields";
import { canShow, Form } from "./form";

function Title({ command, leave }: { command: Command; leave(): void }): VNode {
    return (
        <div class="command-title">
            <div>
                <h3>{command.name}</h3>
                <p class="hint">{command.help}</p>
            </div>
            <button type="button" onClick={leave}>
                Other command
            </button>
        </div>
    );
}

function Live({ form, command }: { form: Form; command: Command }): VNode | null {
    const live = useValue(form.live);
    return canShow(command) ? (
        <label class="tool-check">
            <input
                type="checkbox"
                checked={live}
                onChange={(event) => {
                    form.live.value = event.currentTarget.checked;
                    form.cancel();
                }}
            />
            <span>Show a preview during changes</span>
        </label>
    ) : null;
}

function Line({ form, command }: { form: Form; command: Command }): VNode {
    const [needed] = form.missing;
    return (
        <>
            {form.errorText.value !== "" ? (
                <p class="error" role="alert">
                    {form.errorText.value}
                </p>
            ) : null}
            {needed ? (
                <p class="hint">{`Required: ${needed.name.replaceAll("_", " ")}. ${needed.help}`}</p>
            ) : (
                <code class="command-line" title={usage(command)}>
                    {form.line}
                </code>
            )}
        </>
    );
}

function FilledForm({ app, form, command, again }: { app: App; form: Form; command: Command; again(): void }): VNode {
    const locked = useValue(app.store.connection) !== "ready";
    const first = useMemo(() => initialFields(command, form.values.peek()), [command]);
    const run = async () => {
        if (await form.run()) {
            again();
        }
    };
    const key = (event: KeyboardEvent) => {
        if (event.key === "Escape") {
            event.preventDefault();
            again();
        }
    };
    return (
        <form
            class="command-form"
            noValidate // the fields show their own messages; steps apply only to arrow keys
            tabIndex={-1}
            aria-label={command.name}
            onKeyDown={key}
            onSubmit={(event) => {
                event.preventDefault();
                void run();
            }}
        >
            <Title command={command} leave={() => form.begin(null)} />
            <Tracked
                draw={() => (
                    <>
                        <Fields
                            command={command}
                            first={first}
                            context={fieldContext(app, form.values.value, (name, words, done) => form.set(name, words, done))}
                        />
                        <Live form={form} command={command} />
                        <Line form={form} command={command} />
                        <div class="tool-row">
                            <button type="submit" class="primary" disabled={locked || form.busy.value || form.missing.length > 0}>
                                Run
                            </button>
                            <button type="button" title="Discard the changes made here (Esc)" onClick={again}>
                                Cancel
                            </button>
                        </div>
                    </>
                )}
            />
        </form>
    );
}

const kForms = new WeakMap<App, Form>();

/** The form of a page; its values are kept while its panel is folded. */
export function commandForm(app: App): Form {
    const known = kForms.get(app) ?? new Form(app);
    kForms.set(app, known);
    return known;
}

export function CommandPanel({ app }: { app: App }): VNode {
    const form = commandForm(app);
    const schema = useValue(app.store.schema);
    const command = useValue(form.command);
    const holder = useRef<HTMLDivElement>(null);
    const before = useRef(command);
    useLayoutEffect(() => {
        if (before.current !== command && document.activeElement === document.body) {
            holder.current?.querySelector<HTMLElement>("form, input")?.focus(); // the focused element was removed
        }
        before.current = command;
    }, [command]);
    if (schema.length === 0) {
        return <p class="hint">The commands have not been loaded yet.</p>;
    }
    return (
        <div ref={holder}>
            {command ? (
                <FilledForm key={command.name} app={app} form={form} command={command} again={() => form.begin(command)} />
            ) : (
                <Chooser schema={schema} choose={(one) => form.begin(one)} />
            )}
        </div>
    );
}
