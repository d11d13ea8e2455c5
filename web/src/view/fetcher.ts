// Requests geometry from the engine, the most important first, and never the same one twice at a time.
import type { Engine, Geometry } from "../app";
import { EngineError } from "../app";

const kAtOnce = 2;

export interface Order {
    slot: string; // a newer order for the slot replaces this one
    urgent: boolean; // other orders wait until the user pauses
    fields: Record<string, unknown>; // fields of the `show` request
    done(geometry: Geometry | null): void; // null: the drawn geometry is current
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

    /** Removes the orders with slots of this prefix. */
    drop(prefix: string): void {
        for (const [slot] of [...this.waiting].filter(([name]) => name.startsWith(prefix))) {
            this.waiting.delete(slot);
        }
        for (const [slot, job] of [...this.running].filter(([name]) => name.startsWith(prefix))) {
            job.stop.abort();
            this.running.delete(slot);
        }
    }

    /** Whether the user pauses, so that orders that are not urgent may be sent. */
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
