// The active tool: one at a time, and the events that it receives.
import { type Signal, signal } from "@preact/signals-core";
import type { App, ToolPointer, ToolRun } from "./app";

const kSelect = "select";

export class ActiveTool {
    /** Null if no tool has that name. */
    readonly run: Signal<ToolRun | null> = signal(null);
    /** Changes after each event of the tool, because its status may have changed. */
    readonly eventCount = signal(0);

    constructor(private readonly app: () => App) {}

    take(id: string): void {
        const app = this.app();
        const tool = app.tools.find((one) => one.id === id);
        this.run.peek()?.stop();
        this.run.value = null;
        app.view.setOrbit(true);
        app.store.tool.value = tool ? id : kSelect;
        const taken = tool ?? app.tools.find((one) => one.id === kSelect);
        this.run.value = taken ? taken.start(app) : null;
        app.view.requestDraw();
    }

    pointer(event: ToolPointer): boolean {
        return this.send((run) => run.pointer?.(event));
    }

    wheel(delta: number, event: ToolPointer): boolean {
        return this.send((run) => run.wheel?.(delta, event));
    }

    key(event: KeyboardEvent): boolean {
        if (this.send((run) => run.key?.(event))) {
            return true;
        }
        if (event.key === "Escape" && this.app().store.tool.peek() !== kSelect) {
            this.take(kSelect);
            return true;
        }
        return false;
    }

    private send(receive: (run: ToolRun) => boolean | undefined): boolean {
        const run = this.run.peek();
        if (!run) {
            return false;
        }
        const taken = receive(run) ?? false;
        ++this.eventCount.value;
        return taken;
    }
}
