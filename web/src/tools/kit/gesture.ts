// One gesture: the same line is previewed while it continues, and run once at its end.
import { signal } from "@preact/signals-core";
import type { App, Ran } from "../../app";
import type { ObjectName } from "../../protocol";

export class Gesture {
    private shown = "";
    private readonly errorText = signal("");
    private open = false;

    constructor(
        readonly app: App,
        readonly about?: ObjectName,
    ) {}

    /** The error of the engine for the last previewed line; empty if there is no error. */
    get refusal(): string {
        return this.errorText.value;
    }

    get line(): string {
        return this.shown;
    }

    preview(line: string): void {
        if (line === this.shown) {
            return;
        }
        this.shown = line;
        this.open = true;
        this.app.engine.preview(line, this.about).then(
            (shown) => {
                if (shown) {
                    this.errorText.value = "";
                }
            },
            (error: Error) => {
                this.errorText.value = error.message;
            },
        );
    }

    /** Runs the line; if it is refused, reports the reason and returns null. */
    async run(line: string): Promise<Ran | null> {
        const had = this.open;
        this.open = false;
        this.shown = "";
        try {
            const ran = await this.app.engine.run(line, this.about);
            if (ran.message) {
                this.app.store.notify(ran.message);
            }
            return ran;
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
            if (had) {
                await this.app.engine.endPreview().catch(() => undefined);
            }
            return null;
        }
    }

    /** Removes the preview. */
    cancel(): void {
        if (this.open) {
            this.open = false;
            this.shown = "";
            this.app.engine.endPreview().catch(() => undefined);
        }
    }
}

/** Runs one line that needs no preview. */
export function runLine(app: App, line: string, about?: ObjectName): Promise<Ran | null> {
    return new Gesture(app, about).run(line);
}
