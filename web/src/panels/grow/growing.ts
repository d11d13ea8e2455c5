// A running growth: its intermediate result, and whether that is kept after a stop.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { App } from "../../app";
import type { ObjectName } from "../../protocol";
import { keyOf } from "../../view/object_view";
import { type Bound, type Card, isCancelled, performText, setShown } from "./card";

export interface Growing {
    phase: "running" | "stopped";
    nodes: number; // so far
    until: string; // the option with which the command ends at this state; empty before the first step
}

/** The option that ends a command at its intermediate result, split into name and value. */
export function optionOf(until: string): { name: string; value: string } {
    const at = until.indexOf("=");
    return { name: until.slice(0, at), value: until.slice(at + 1) };
}

export class GrowthWatch {
    readonly now: Signal<Growing | null> = signal(null);
    private aside: ObjectName | null = null; // the older tree, hidden while the new one grows

    constructor(private readonly app: App) {}

    /** Runs a text with a first line that grows a tree. After a stop, the intermediate result remains in the view. */
    async perform(text: string, bound: Bound | null, target: ObjectName | null): Promise<void> {
        const { store } = this.app;
        this.now.value = { phase: "running", nodes: 0, until: "" };
        store.grown.value = null;
        store.keepsGrowthPreview.value = true;
        const stop = effect(() => {
            const grown = store.grown.value;
            if (grown) {
                this.now.value = { phase: "running", nodes: grown.nodes, until: grown.until };
                this.putAside(bound ? target : null);
            }
        });
        try {
            await performText(this.app, text, bound, target);
            this.end();
        } catch (error) {
            if (!isCancelled(error)) {
                this.end();
            }
            throw error;
        } finally {
            stop();
        }
    }

    /** Asks the user to keep or discard the intermediate result. */
    stopped(): void {
        const so = this.now.peek();
        if (so?.until) {
            this.now.value = { ...so, phase: "stopped" };
        } else {
            this.end();
            this.app.store.notify("Stopped before the tree had grown; the scene is unchanged.");
        }
    }

    /** Grows to the same state again, and keeps it. */
    keep(card: Card): void {
        const so = this.now.peek();
        if (so) {
            const { name, value } = optionOf(so.until);
            card.take(name, value);
            void card.run();
        }
    }

    throwAway(card: Card): void {
        this.end();
        card.reread();
    }

    /** Ends the growth and removes its intermediate result. */
    end(): void {
        this.now.value = null;
        this.bringBack();
        this.app.store.keepsGrowthPreview.value = false;
    }

    private putAside(object: ObjectName | null): void {
        if (object && !this.aside && !this.app.store.hidden.peek().has(keyOf(object))) {
            this.aside = object;
            setShown(this.app, object, false);
        }
    }

    private bringBack(): void {
        if (this.aside) {
            setShown(this.app, this.aside, true);
            this.aside = null;
        }
    }
}
