// One dialog for all questions of a menu item.
import type { VNode } from "preact";
import { useId, useState } from "preact/hooks";
import type { App } from "../../app";
import type { Argument } from "../../protocol";
import { kindsOf, shortUnit } from "../../script/commands";
import { openDialog, Dialog, ErrorText, useWork } from "../files/dialog";
import { answerError, argumentsOf, type Part } from "./fill";

interface Question {
    label: string;
    value: string;
    argument?: Argument;
}

/** Asks, and runs the resulting line; the dialog remains open as long as it is refused. Null if the user cancels. */
export function requestAnswers<T>(app: App, title: string, parts: readonly Part[], run: (answers: readonly string[]) => Promise<T>): Promise<T | null> {
    const partArguments = argumentsOf(app.store.schema.peek(), parts);
    const questions = parts.flatMap((part, at) => (part.is === "ask" ? [{ label: part.label, value: part.value, argument: partArguments[at] }] : []));
    return openDialog((end) => <QuestionDialog app={app} title={title.replace(/(…|\.\.\.)$/, "")} questions={questions} run={run} end={end} />);
}

interface QuestionProps<T> {
    app: App;
    title: string;
    questions: readonly Question[];
    run(answers: readonly string[]): Promise<T>;
    end(answer: T | null): void;
}

function QuestionDialog<T>({ app, title, questions, run, end }: QuestionProps<T>): VNode {
    const [answers, setAnswers] = useState(questions.map((question) => proposed(app, question)));
    const { busy, errorText, work } = useWork();
    const { objects } = app.store.state.peek();
    const wrong = questions.map(({ argument }, at) => answerError(answers[at], argument, objects));
    const ready = !busy && wrong.every((text) => text === "");
    return (
        <Dialog
            title={title}
            close={() => end(null)}
            accept={ready ? () => void work(async () => end(await run(answers))) : undefined}
            buttons={
                <>
                    <button type="submit" class="primary" disabled={!ready}>
                        OK
                    </button>
                    <button type="button" onClick={() => end(null)}>
                        Cancel
                    </button>
                </>
            }
        >
            {questions.map((question, at) => (
                <Answer
                    key={at}
                    app={app}
                    question={question}
                    first={at === 0}
                    answer={answers[at]}
                    wrong={wrong[at]}
                    set={(answer) => setAnswers(answers.map((old, n) => (n === at ? answer : old)))}
                />
            ))}
            <ErrorText text={errorText} />
        </Dialog>
    );
}

function choicesOf(app: App, argument: Argument | undefined): readonly string[] {
    switch (argument?.type) {
        case "choice":
            return argument.choices ?? [];
        case "flag":
            return ["true", "false"];
        case "object":
            return app.store.state
                .peek()
                .objects.filter(({ kind }) => kindsOf(argument).includes(kind))
                .map(({ name }) => name);
        default:
            return [];
    }
}

/** The initial answer: if the proposed object does not exist, an existing one. */
function proposed(app: App, { value, argument }: Question): string {
    const choices = argument?.type === "object" ? choicesOf(app, argument) : [];
    return choices.length > 0 && !choices.includes(value) ? choices[0] : value;
}

interface AnswerProps {
    app: App;
    question: Question;
    first: boolean;
    answer: string;
    wrong: string;
    set(answer: string): void;
}

function Answer({ app, question: { label, argument }, first, answer, wrong, set }: AnswerProps): VNode {
    const id = useId();
    const choices = choicesOf(app, argument);
    const unit = argument?.unit ? ` [${shortUnit(argument)}]` : "";
    return (
        <div class="file-field" title={argument?.help}>
            <label for={id}>{label + unit}</label>
            {choices.length > 0 ? (
                <select id={id} value={answer} autofocus={first} onChange={(event) => set(event.currentTarget.value)}>
                    {!choices.includes(answer) && <option value={answer}>{answer}</option>}
                    {choices.map((choice) => (
                        <option key={choice} value={choice}>
                            {choice}
                        </option>
                    ))}
                </select>
            ) : (
                <input
                    id={id}
                    type="text"
                    value={answer}
                    autofocus={first}
                    spellcheck={false}
                    aria-invalid={wrong !== ""}
                    aria-describedby={`${id}-wrong`}
                    onFocus={(event) => event.currentTarget.select()}
                    onInput={(event) => set(event.currentTarget.value)}
                />
            )}
            <p id={`${id}-wrong`} class="error" aria-live="polite">
                {wrong}
            </p>
        </div>
    );
}
