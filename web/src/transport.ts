// The connection to the engine by WebSocket and HTTP: docs/library/studio-protocol.md.
import { type Connection, type Engine, EngineError, type Geometry, type Ran } from "./app";
import { parseGeometry } from "./blob";
import type { ErrorKind, Grown, ObjectName, State } from "./protocol";

const kVersion = 1;
const kFirstWait = 250; // [ms] delay before the second attempt to connect
const kLongestWait = 5000;

/** Callbacks of the transport into the page. */
export interface Listener {
    connection(now: Connection): void;
    folder(path: string): void; // path of the open folder
    state(state: State): void;
    progress(statement: number | null, fraction: number): void;
    grown(grown: Grown): void;
    geometry(geometry: Geometry): void; // of a preview, or of the objects it had changed when it ends
    // The `surface` and `have` fields of a preview request about an object.
    follows(about?: ObjectName): Record<string, unknown>;
    settled(): void; // previews have become part of the document, or were discarded
    warned(text: string): void; // the request succeeded, but an additional action failed: the journal
    refused(reason: string): void; // the server refuses this page
}

export interface TransportOptions {
    origin: string; // "http://127.0.0.1:4000"
    token: string;
    socket?: (url: string) => WebSocket; // for tests
    fetch?: typeof fetch;
}

interface Pending {
    text: string; // as sent, and sent again after a reconnect
    resolve(reply: unknown): void;
    reject(error: Error): void;
}

interface Preview {
    line: string;
    about?: ObjectName;
    surface?: Record<string, unknown>;
    resolve(shown: boolean): void;
    reject(error: Error): void;
}

type Reply = { re: number; ok: boolean; error?: string; kind?: ErrorKind; warning?: string };

// Requests that change nothing may wait for a lost connection to return; others are refused during that time.
const kHarmless = new Set([
    "show",
    "material",
    "slice",
    "schema",
    "help",
    "complete",
    "describe",
    "check",
    "anchor",
    "files",
    "library",
    "branch",
    "menu",
    "ping",
    "endpreview",
]);

// Requests that change the document: they end the previews.
const kChanges = new Set(["run", "text", "ran", "undo", "redo", "rerun", "open"]);

function clientName(): string {
    const bytes = crypto.getRandomValues(new Uint8Array(16));
    return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

function encodePath(name: string): string {
    return name.split("/").map(encodeURIComponent).join("/");
}

export class Transport implements Engine {
    /** The name of this client in the field `by` of STATE. Ids restart with each page, and so does the name. */
    readonly client = clientName();

    private socket: WebSocket | null = null;
    private ready = false;
    private closed = false;
    private wait = kFirstWait;
    private timer: ReturnType<typeof setTimeout> | undefined;
    private lastId = 0;
    private lastSeq = 0;
    private wanted = 0; // earlier previews are out of date
    private readonly pending = new Map<number, Pending>();
    private fetching = 0; // number of blobs being fetched
    private previewing = false;
    private previewed: ObjectName | undefined; // object of the last preview
    private nextPreview: Preview | null = null;

    constructor(
        private readonly options: TransportOptions,
        private readonly listener: Listener,
    ) {}

    connect(): void {
        const url = `${this.options.origin.replace(/^http/, "ws")}/ws`;
        const socket = this.options.socket?.(url) ?? new WebSocket(url);
        socket.binaryType = "arraybuffer";
        this.socket = socket;
        socket.onopen = () => {
            socket.send(JSON.stringify({ type: "hello", version: kVersion, token: this.options.token, client: this.client }));
        };
        socket.onmessage = (event: MessageEvent) => this.receive(event.data as string | ArrayBuffer);
        socket.onclose = (event: CloseEvent) => this.lost(socket, event);
        socket.onerror = () => undefined; // a close event follows
    }

    close(): void {
        this.closed = true;
        clearTimeout(this.timer);
        this.socket?.close();
    }

    request<R = Record<string, unknown>>(type: string, fields: Record<string, unknown> = {}): Promise<R> {
        if (!this.ready && !kHarmless.has(type)) {
            return Promise.reject(new EngineError("The studio is not connected; wait until it is.", "busy"));
        }
        const id = ++this.lastId;
        const text = JSON.stringify({ id, type, ...fields });
        const reply = new Promise<R>((resolve, reject) => {
            this.pending.set(id, { text, resolve: resolve as (reply: unknown) => void, reject });
            if (this.ready) {
                this.socket?.send(text);
            }
        });
        if (kChanges.has(type)) {
            this.dropPreview();
            reply.catch(() => undefined).finally(() => this.listener.settled());
        }
        return reply;
    }

    run(line: string, about?: ObjectName): Promise<Ran> {
        return this.request("run", { line, about });
    }

    preview(line: string, about?: ObjectName, surface?: Record<string, unknown>): Promise<boolean> {
        return new Promise((resolve, reject) => {
            this.nextPreview?.resolve(false);
            this.nextPreview = { line, about, surface, resolve, reject };
            this.sendPreview();
        });
    }

    endPreview(): Promise<void> {
        const about = this.previewed;
        this.dropPreview();
        return this.request("endpreview", this.listener.follows(about)).then(() => this.listener.settled());
    }

    cancel(): void {
        this.request("cancel").catch(() => undefined);
    }

    async blob(key: string, stop?: AbortSignal): Promise<Geometry> {
        return parseGeometry(await this.fetchBlob(key, (response) => response.arrayBuffer(), stop));
    }

    image(key: string): Promise<Blob> {
        return this.fetchBlob(key, (response) => response.blob());
    }

    async file(name: string): Promise<Blob> {
        return (await this.http(`/file/${encodePath(name)}`)).blob();
    }

    async upload(name: string, data: Blob, overwrite = false): Promise<{ file: string; bytes: number }> {
        const headers: Record<string, string> = overwrite ? { "X-Overwrite": "yes" } : {};
        const response = await this.http(`/file/${encodePath(name)}`, { method: "PUT", body: data, headers });
        return (await response.json()) as { file: string; bytes: number };
    }

    /** Whether all responses have arrived. */
    get idle(): boolean {
        return this.pending.size === 0 && this.fetching === 0;
    }

    private async fetchBlob<T>(key: string, read: (response: Response) => Promise<T>, stop?: AbortSignal): Promise<T> {
        ++this.fetching;
        try {
            return await read(await this.http(`/blob/${encodeURIComponent(key)}`, { signal: stop }));
        } finally {
            --this.fetching;
        }
    }

    private async http(path: string, init: RequestInit = {}): Promise<Response> {
        const headers = { ...(init.headers as Record<string, string>), Authorization: `Bearer ${this.options.token}` };
        const send = this.options.fetch ?? fetch;
        const response = await send(this.options.origin + path, { ...init, headers, credentials: "omit", redirect: "error" });
        if (!response.ok) {
            const reason = (await response.text()).trim();
            throw new EngineError(reason || `The studio answered ${response.status} to ${path}.`, response.status >= 500 ? "internal" : "files");
        }
        return response;
    }

    private sendPreview(): void {
        const next = this.nextPreview;
        if (this.previewing || !next) {
            return;
        }
        this.nextPreview = null;
        this.previewing = true;
        this.previewed = next.about;
        const seq = ++this.lastSeq;
        const fields: Record<string, unknown> = { seq, line: next.line, about: next.about, ...this.listener.follows(next.about) };
        if (next.surface) {
            fields.surface = next.surface;
        }
        this.request<{ dropped?: boolean }>("preview", fields)
            .then((reply) => next.resolve(!reply.dropped && seq >= this.wanted), next.reject)
            .finally(() => {
                this.previewing = false;
                this.sendPreview();
            });
    }

    // Results of a pending preview are discarded.
    private dropPreview(): void {
        this.nextPreview?.resolve(false);
        this.nextPreview = null;
        this.wanted = this.lastSeq + 1;
    }

    private receive(data: string | ArrayBuffer): void {
        if (typeof data !== "string") {
            const geometry = parseGeometry(data);
            if (geometry.header.seq === undefined || geometry.header.seq >= this.wanted) {
                this.listener.geometry(geometry);
            }
            return;
        }
        const message = JSON.parse(data) as { type?: string; re?: number };
        if (message.re !== undefined) {
            this.answer(message as Reply);
        } else if (message.type === "welcome") {
            const { state, folder } = message as unknown as { state: State; folder: string };
            this.listener.folder(folder);
            this.welcome(state);
        } else if (message.type === "state") {
            this.listener.state(message as unknown as State);
        } else if (message.type === "progress") {
            const { statement, fraction } = message as unknown as { statement: number | null; fraction: number };
            this.listener.progress(statement, fraction);
        } else if (message.type === "grown") {
            this.listener.grown(message as unknown as Grown);
        }
    }

    private welcome(state: State): void {
        this.wait = kFirstWait;
        // Waiting requests are sent first, since ids ascend: the state makes the page send further requests.
        for (const [, request] of [...this.pending].sort(([a], [b]) => a - b)) {
            this.socket?.send(request.text);
        }
        this.ready = true;
        this.listener.state(state);
        this.listener.connection("ready");
    }

    private answer(reply: Reply): void {
        const request = this.pending.get(reply.re);
        if (!request) {
            return;
        }
        this.pending.delete(reply.re);
        if (reply.warning) {
            this.listener.warned(reply.warning);
        }
        if (reply.ok) {
            request.resolve(reply);
        } else {
            request.reject(new EngineError(reply.error ?? "The studio refused without a reason.", reply.kind ?? "internal"));
        }
    }

    private lost(socket: WebSocket, event: CloseEvent): void {
        if (socket !== this.socket) {
            return;
        }
        this.ready = false;
        this.socket = null;
        if (this.closed) {
            return;
        }
        const isRefused = event.code === 1008; // policy violation: another attempt would fail in the same way
        this.listener.connection(isRefused ? "refused" : "lost");
        if (isRefused) {
            this.listener.refused(event.reason || "The studio refused this page; open it again from the terminal.");
            return;
        }
        this.timer = setTimeout(() => this.connect(), this.wait);
        this.wait = Math.min(this.wait * 2, kLongestWait);
    }
}
