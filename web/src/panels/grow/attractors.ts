// The points that a tree grows into, also if the view does not show them.
import { signal } from "@preact/signals-core";
import type { App, Geometry } from "../../app";

export class Attractors {
    private readonly fetched = signal<{ key: string; geometry: Geometry | null } | null>(null);

    constructor(private readonly app: App) {}

    /** Undefined until they have arrived; signals report the arrival. */
    of(name: string | undefined): Geometry | undefined {
        const object = this.app.store.state.value.objects.find((one) => one.kind === "points" && one.name === name);
        const shown = object && this.app.view.geometry(object, "points");
        if (!object || shown) {
            return shown;
        }
        const key = `${object.name}:${object.version}`;
        if (this.fetched.value?.key === key) {
            return this.fetched.value.geometry ?? undefined;
        }
        void this.fetch(object.name, key);
        return undefined;
    }

    private async fetch(name: string, key: string): Promise<void> {
        await Promise.resolve(); // not during a redraw
        if (this.fetched.peek()?.key === key) {
            return;
        }
        this.fetched.value = { key, geometry: null };
        try {
            const reply = await this.app.engine.request<{ key: string }>("show", { kind: "points", name, form: "points" });
            this.fetched.value = { key, geometry: await this.app.engine.blob(reply.key) };
        } catch {
            // the next version is requested again; without it only the balls at the roots are shown
        }
    }
}
