// Shows a film in the view: fetches and stores frames in sequence, and plays those that have arrived.
import { effect, type Signal, signal } from "@preact/signals-core";
import type { App, Geometry } from "../../../app";
import type { ImageKeys } from "../../../protocol";
import { barkOf } from "../../../view/sources";
import { type Film, frameAt, frameCount, motionFields, moves, timeOf } from "./timeline";

const kMaxBytes = 256 * 1024 * 1024; // of stored frames
const kAtOnce = 2;
const kFirstState = 500_000_000; // first number of the frames, beyond all states of surfaces that the engine counts

function bytesOf({ arrays }: Geometry): number {
    return Object.values(arrays).reduce((sum, array) => sum + array.byteLength, 0);
}

export class Player {
    readonly time = signal(0); // [s]
    readonly playing = signal(false);
    readonly open = signal(false); // whether a frame is shown, and not the tree at rest
    readonly fetched = signal(0); // number of stored frames
    readonly errorText = signal("");
    private readonly frames = new Map<number, Geometry>();
    private bytes = 0;
    private about = ""; // motion of the stored frames
    private bark: string | undefined; // name of a material
    private version = -1; // version of their tree
    private coming = new Set<number>(); // requested frames
    private shown = -1; // frame
    private state = 0; // number of the drawn frame
    private from = 0; // [ms] start time of the playing film
    private readonly stopWatching: () => void;

    constructor(
        private readonly app: App,
        private readonly film: Signal<Film>,
    ) {
        this.stopWatching = effect(() => {
            void this.film.value;
            const tree = this.app.store.state.value.objects.find(({ kind, name }) => kind === "skeleton" && name === this.film.value.tree);
            this.bark = barkOf(this.app.store, this.film.value.tree);
            this.follow(JSON.stringify([motionFields(this.film.value), this.bark]), tree?.version ?? 0);
        });
    }

    /** Shows a time of the film. */
    seek(time: number): void {
        this.time.value = Math.min(Math.max(time, 0), this.film.peek().duration);
        this.open.value = true;
        this.from = performance.now() - this.time.peek() * 1000;
        this.show();
        this.fetch();
    }

    play(): void {
        if (!moves(this.film.peek())) {
            return;
        }
        const isOver = this.time.peek() >= this.film.peek().duration - 1e-6;
        this.seek(isOver ? 0 : this.time.peek());
        this.playing.value = true;
        requestAnimationFrame(() => this.tick());
    }

    pause(): void {
        this.playing.value = false;
    }

    /** Returns to the tree at rest. */
    close(): void {
        this.playing.value = false;
        if (this.open.peek()) {
            this.open.value = false;
            this.shown = -1;
            this.app.view.settle();
        }
    }

    dispose(): void {
        this.close();
        this.stopWatching();
    }

    // For another film or tree, the stored frames are invalid. After a change, the tree is shown at rest.
    private follow(motion: string, version: number): void {
        const about = `${version} ${motion}`;
        if (about !== this.about) {
            if (version !== this.version) {
                this.close();
            }
            this.version = version;
            this.about = about;
            this.frames.clear();
            this.coming = new Set();
            this.bytes = 0;
            this.shown = -1;
            this.fetched.value = 0;
            this.errorText.value = "";
            if (this.open.peek()) {
                this.fetch();
            }
        }
    }

    private tick(): void {
        if (!this.playing.peek()) {
            return;
        }
        const film = this.film.peek();
        const now = (performance.now() - this.from) / 1000;
        const length = timeOf(film, frameCount(film));
        if (now >= length) {
            this.from += Math.floor(now / length) * length * 1000; // repeats the film
        }
        this.time.value = Math.min((performance.now() - this.from) / 1000, film.duration);
        this.show();
        this.fetch();
        requestAnimationFrame(() => this.tick());
    }

    // Shows the frame of the current time, or if a playing film does not have it yet, the newest before it.
    private show(): void {
        const film = this.film.peek();
        let frame = frameAt(film, this.time.peek());
        while (this.playing.peek() && frame > 0 && !this.frames.has(frame)) {
            --frame;
        }
        const geometry = this.frames.get(frame);
        if (!geometry || frame === this.shown || !this.open.peek()) {
            return;
        }
        this.shown = frame;
        const { position, normal } = geometry.arrays;
        const drawn = this.app.view.geometry(geometry.header.object, "surface")?.header.version;
        const base = kFirstState + this.state;
        const header = { ...geometry.header, seq: 0, version: kFirstState + ++this.state };
        if (drawn !== base || film.grow) {
            // a growing tree has different faces in each frame
            // Patches are written into the drawn arrays.
            this.app.view.receive({ header, arrays: { ...geometry.arrays, position: position.slice(), normal: normal.slice() } });
            return;
        }
        const vertices = position.length / 3;
        const quads = geometry.arrays.quads.length / 4;
        const all: [number, number][] = [[0, vertices]];
        this.app.view.receive({
            header: { ...header, kind: "patch", base, ranges: { vertices: all, quads: [] }, vertices, quads },
            arrays: { position, normal },
        });
    }

    /** The next frame to fetch: the frame of the current time, then, while the film plays, the following ones. */
    private wanted(): number | null {
        const film = this.film.peek();
        const now = frameAt(film, this.time.peek());
        if (!this.open.peek() || !moves(film)) {
            return null;
        }
        const isMissing = (frame: number) => !this.frames.has(frame) && !this.coming.has(frame);
        if (isMissing(now)) {
            return now;
        }
        const count = frameCount(film);
        for (let ahead = 1; this.playing.peek() && ahead < count && this.bytes < kMaxBytes; ++ahead) {
            if (isMissing((now + ahead) % count)) {
                return (now + ahead) % count;
            }
        }
        return null;
    }

    // A frame is computed while the previous one is transferred.
    private fetch(): void {
        for (let frame = this.wanted(); frame !== null && this.coming.size < kAtOnce; frame = this.wanted()) {
            void this.fetchOne(frame);
        }
    }

    private async fetchOne(frame: number): Promise<void> {
        const { about, coming } = this;
        coming.add(frame);
        const film = this.film.peek();
        try {
            const fields = { ...motionFields(film), material: this.bark, time: timeOf(film, frame) };
            const { key, images } = await this.app.engine.request<{ key: string; images: ImageKeys[] }>("frame", fields);
            const geometry = await this.app.engine.blob(key);
            if (about === this.about) {
                this.keep(frame, { ...geometry, header: { ...geometry.header, images } });
                this.show();
            }
        } catch (error) {
            if (about === this.about) {
                this.errorText.value = (error as Error).message;
                this.close();
            }
        } finally {
            coming.delete(frame);
            this.fetch();
        }
    }

    private keep(frame: number, geometry: Geometry): void {
        if (this.bytes >= kMaxBytes) {
            this.frames.clear();
            this.bytes = 0;
        }
        const { position, normal, ...common } = geometry.arrays;
        const alike = this.film.peek().grow ? undefined : [...this.frames.values()][0]?.arrays;
        // Copies: the arrays are views of the whole response, and a film needs the faces and their bark once.
        const copied = { position: position.slice(), normal: normal.slice() };
        const shared = Object.fromEntries(Object.entries(common).map(([name, array]) => [name, alike?.[name] ?? array.slice()]));
        this.frames.set(frame, { header: geometry.header, arrays: { ...shared, ...copied } });
        this.bytes += bytesOf({ ...geometry, arrays: alike ? copied : geometry.arrays });
        this.fetched.value = this.frames.size;
    }
}
