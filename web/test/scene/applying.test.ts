// Applies typed text to the document while others change it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type App, EngineError } from "../../src/app";
import { Applying } from "../../src/panels/scene/editor/applying";
import { textOf } from "../../src/script/pieces";
import { createStore } from "../../src/store";
import { stateOf } from "./schema";

globalThis.setTimeout = (() => 0) as unknown as typeof setTimeout; // timers are disabled

/** A document that accepts texts like the engine, and a user who types. */
class Desk {
    readonly store = createStore();
    readonly requests: Record<string, unknown>[] = [];
    cancelled = 0;
    typed = "";
    refuse: EngineError | null = null;
    before: (() => void) | null = null; // called before a text arrives
    hold: Promise<void> | null = null; // time until which a text runs
    readonly applying: Applying;

    constructor(text: string) {
        const request = async (_: string, fields: Record<string, unknown>) => {
            this.requests.push(fields);
            this.before?.();
            this.before = null;
            await this.hold;
            if (this.refuse) {
                throw this.refuse;
            }
            if (fields.revision !== this.store.state.peek().revision) {
                throw new EngineError("the document has changed since", "input");
            }
            this.publish(String(fields.text), "me");
            return {};
        };
        const engine = { client: "me", request, cancel: () => ++this.cancelled };
        this.applying = new Applying({ store: this.store, engine } as unknown as App, {
            text: () => this.typed,
            write: (now) => {
                this.typed = now;
            },
            isHalfTyped: () => false,
            changed: () => undefined,
        });
        this.store.connection.value = "ready";
        this.publish(text, "");
    }

    publish(text: string, by: string): void {
        this.store.state.value = { ...stateOf(text), revision: this.store.state.peek().revision + 1, by };
        this.applying.receive(this.store.state.peek());
    }

    get document(): string {
        return textOf(this.store.state.peek().statements);
    }

    get kind(): string {
        return this.applying.status.peek().kind;
    }
}

test("typed text is restored after a reload and merged with later changes", () => {
    const kept = new Map<string, string>();
    const storage = {
        getItem: (key: string) => kept.get(key) ?? null,
        setItem: (key: string, value: string) => void kept.set(key, value),
        removeItem: (key: string) => void kept.delete(key),
    };
    Object.assign(globalThis, { sessionStorage: storage });
    const before = new Desk("sphere a\nsphere b\n");
    before.typed = "sphere a\nsphere b\nbox c low=";
    before.applying.typed();
    const after = new Desk("sphere a radius=2\nsphere b\n");
    assert.equal(after.typed.trimEnd(), "sphere a radius=2\nsphere b\nbox c low=");
    assert.equal(after.kind, "typed");
    after.typed = "sphere a radius=2\nsphere b\n";
    after.applying.typed();
    assert.equal(new Desk("sphere b\n").typed, "sphere b\n", "undone text is not kept");
    assert.equal(kept.size, 0);
    Object.assign(globalThis, { sessionStorage: undefined });
});

test("typed text is applied to the document once", async () => {
    const desk = new Desk("sphere a\n");
    assert.equal(desk.typed, "sphere a\n");
    desk.typed = "sphere a\nsphere b";
    desk.applying.typed();
    assert.equal(desk.kind, "typed");
    await desk.applying.apply();
    await desk.applying.apply();
    assert.deepEqual(desk.requests, [{ text: "sphere a\nsphere b\n", revision: 1, count: undefined, name: "change in line 2", joins: true }]);
    assert.equal(desk.document, "sphere a\nsphere b\n");
    assert.equal(desk.typed, "sphere a\nsphere b"); // the line of the cursor is unchanged
    assert.equal(desk.kind, "same");
});

test("an earlier gesture and the typed text are both kept", async () => {
    const desk = new Desk("sphere a\nsphere b\n");
    desk.typed = "sphere a\nsphere b radius=2\n";
    desk.before = () => desk.publish("sphere a\nscale a 2\nsphere b\n", "me");
    await desk.applying.apply(); // refused: the revision was not the newest
    assert.equal(desk.typed, "sphere a\nscale a 2\nsphere b radius=2\n");
    assert.equal(desk.kind, "typed");
    assert.deepEqual(desk.store.messages.peek(), []);
    await desk.applying.apply();
    assert.equal(desk.document, "sphere a\nscale a 2\nsphere b radius=2\n");
});

test("a conflict blocks applying until one side is chosen", async () => {
    const desk = new Desk("sphere a\n");
    desk.typed = "sphere a radius=2\n";
    desk.publish("sphere a law=soft\n", "other");
    assert.equal(desk.kind, "conflict");
    assert.equal(desk.applying.status.peek().theirs, "sphere a law=soft");
    assert.match(desk.applying.note.peek(), /another tab/);
    await desk.applying.apply();
    assert.equal(desk.requests.length, 0);
    assert.equal(desk.typed, "sphere a radius=2\n");
    desk.applying.settle("mine");
    await Promise.resolve();
    assert.equal(desk.requests[0].text, "sphere a radius=2\n");

    const other = new Desk("sphere a\n");
    other.typed = "sphere a radius=2\n";
    other.publish("sphere a law=soft\n", "other");
    other.applying.settle("theirs");
    assert.equal(other.typed, "sphere a law=soft\n");
    assert.equal(other.requests.length, 0);
});

test("a newer text cancels changed statements and waits for unchanged ones", async () => {
    const desk = new Desk("sphere a\n");
    let release = () => {};
    desk.hold = new Promise<void>((resolve) => {
        release = resolve;
    });
    desk.typed = "sphere a\ngrow t a\nmesh t\n";
    const first = desk.applying.apply();
    assert.equal(desk.kind, "applying");
    desk.store.state.value = { ...desk.store.state.peek(), running: 1 };
    desk.typed = "sphere a\ngrow t a\nmesh t levels=1\n";
    await desk.applying.apply();
    assert.equal(desk.cancelled, 0);
    desk.typed = "sphere a\ngrow t a step=2\nmesh t levels=1\n";
    await desk.applying.apply();
    assert.equal(desk.cancelled, 1);
    assert.equal(desk.requests.length, 1);
    release();
    await first;
    assert.equal(desk.typed, "sphere a\ngrow t a step=2\nmesh t levels=1\n");
    await desk.applying.apply();
    assert.equal(desk.document, "sphere a\ngrow t a step=2\nmesh t levels=1\n");
});

test("a rejected text remains in the editor, and its error is reported once", async () => {
    const desk = new Desk("sphere a\n");
    desk.typed = "sphere a\nsphere b\n";
    desk.refuse = new EngineError("the text has more than 100000 lines", "input");
    await desk.applying.apply();
    assert.equal(desk.kind, "typed");
    assert.deepEqual(
        desk.store.messages.peek().map(({ text }) => text),
        ["the text has more than 100000 lines"],
    );
    assert.equal(desk.typed, "sphere a\nsphere b\n");
    desk.store.connection.value = "lost";
    await desk.applying.apply();
    assert.equal(desk.requests.length, 1);
});
