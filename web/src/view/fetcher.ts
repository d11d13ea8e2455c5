// Asks the engine for geometry, what is wanted first at first, and never the same twice at once.
import type { Engine, Geometry } from "../app";
import { EngineError } from "../app";

const kAtOnce = 2;

export interface Order {
    slot: string; // a newer order for it replaces this one
    urgent: boolean; // others wait until hands rest
    fields: Record<string, unknown>; // of `show`
    done(geometry: Geometry | null): void; // null: what is drawn is the newest
    failed(error: Error): void;
}

interface Job extends Order {
    stop: AbortController;
}

export class Fetcher {
    private readonly waiting = new Map<string, Job>();
    private readonly running = new Map<string, Job>();
    private resting = true;

    constructor(private readonly engine: Engine) {}

    order(order: Order): void {
        this.drop(order.slot);
        this.waiting.set(order.slot, { ...order, stop: new AbortController() });
        this.next();
    }

    /** Forgets what was ordered for slots that begin so. */
    drop(prefix: string): void {
        for (const [slot] of [...this.waiting].filter(([name]) => name.startsWith(prefix))) {
            this.waiting.delete(slot);
        }
        for (const [slot, job] of [...this.running].filter(([name]) => name.startsWith(prefix))) {
            job.stop.abort();
            this.running.delete(slot);
        }
    }

    /** Whether hands rest, so that what is not urgent may be asked for. */
    setResting(resting: boolean): void {
        this.resting = resting;
        this.next();
    }

    get busy(): boolean {
        return this.waiting.size + this.running.size > 0;
    }

    private next(): void {
        while (this.running.size < kAtOnce) {
            const jobs = [...this.waiting.values()];
            const job = jobs.find((one) => one.urgent) ?? (this.resting ? jobs[0] : undefined);
            if (!job) {
                return;
            }
            this.waiting.delete(job.slot);
            this.running.set(job.slot, job);
            void this.fetch(job);
        }
    }

    private async fetch(job: Job): Promise<void> {
        try {
            const { key } = await this.engine.request<{ key: string | null }>("show", job.fields);
            if (!job.stop.signal.aborted) {
                const geometry = key === null ? null : await this.engine.blob(key, job.stop.signal);
                if (!job.stop.signal.aborted) {
                    job.done(geometry);
                }
            }
        } catch (error) {
            if (!job.stop.signal.aborted) {
                job.failed(error instanceof Error ? error : new EngineError(String(error), "internal"));
            }
        } finally {
            if (this.running.get(job.slot) === job) {
                this.running.delete(job.slot);
            }
            this.next();
        }
    }
}
