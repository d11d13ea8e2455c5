// The edited sketch: its history, the reconstruction by the engine, and the command that adds it to the scene.
import { type Signal, signal } from "@preact/signals-core";
import type { App } from "../app";
import { runLine } from "../tools/kit/gesture";
import { commandLine } from "../tools/kit/words";
import { canReconstruct, changeView, emptySketch, levelIn, type Pixel, readSketch, type Sketch, type SketchView, withPicture, writtenSketch } from "./model";
import { SketchTree } from "./tree";

export interface Fit {
    name: string;
    refused: string; // reason; empty if the branch was reconstructed
    length_m: number;
    matched: number;
}

/** The position of the pointer, and the view in which the corresponding line is computed. */
interface Looked {
    view: SketchView;
    other: SketchView;
    at: Pixel;
}

const kMaxSteps = 500;

export class SketchWork {
    readonly sketch: Signal<Sketch> = signal(emptySketch());
    readonly chosen: Signal<string | null> = signal(null);
    readonly point = signal(-1);
    readonly fits: Signal<readonly Fit[]> = signal([]);
    readonly errorText = signal("");
    readonly name = signal("tree");
    readonly width = signal(12); // [px] width of a new stroke
    readonly line: Signal<{ view: string; points: readonly Pixel[] } | null> = signal(null);
    readonly pictures: Signal<ReadonlyMap<string, ImageBitmap>> = signal(new Map());
    readonly files: Signal<readonly string[]> = signal([]); // files of the folder
    readonly canUndo = signal(false);
    readonly canRedo = signal(false);
    private before: Sketch[] = [];
    private after: Sketch[] = [];
    private readonly tree: SketchTree;
    private requestCount = 0;
    private isRequesting = false;
    private looked: Looked | null = null;
    private isRequestingLine = false;

    constructor(readonly app: App) {
        this.tree = new SketchTree(app);
        this.name.value = app.store.freeName("tree");
        void this.list();
    }

    private async list(): Promise<void> {
        try {
            const { files } = await this.app.engine.request<{ files: { name: string }[] }>("files", {});
            this.files.value = files.map(({ name }) => name);
        } catch {
            // then the list of files is empty
        }
    }

    stop(): void {
        ++this.requestCount;
        this.lookAway();
        this.tree.stop();
        this.pictures.peek().forEach((picture) => picture.close());
    }

    /** Replaces the sketch, with a step of undo; `step` is false while a drag continues the same step. */
    set(next: Sketch, step = true): void {
        if (next === this.sketch.peek()) {
            return;
        }
        if (step) {
            this.keep();
        }
        this.sketch.value = next;
    }

    private keep(): void {
        this.before = [...this.before, this.sketch.peek()].slice(-kMaxSteps);
        this.after = [];
        this.marks();
    }

    undo(): void {
        const last = this.before.pop();
        if (last) {
            this.after.push(this.sketch.peek());
            this.sketch.value = last;
            this.marks();
            void this.rebuild();
        }
    }

    redo(): void {
        const next = this.after.pop();
        if (next) {
            this.before.push(this.sketch.peek());
            this.sketch.value = next;
            this.marks();
            void this.rebuild();
        }
    }

    private marks(): void {
        this.canUndo.value = this.before.length > 0;
        this.canRedo.value = this.after.length > 0;
    }

    /** Requests the tree; during a request, the newest sketch waits. */
    async rebuild(): Promise<void> {
        const mine = ++this.requestCount;
        if (this.isRequesting) {
            return;
        }
        const sketch = this.sketch.peek();
        if (!canReconstruct(sketch)) {
            this.fits.value = [];
            this.errorText.value = "";
            this.tree.clear();
            return;
        }
        this.isRequesting = true;
        try {
            const { key, branches } = await this.app.engine.request<{ key: string; branches: Fit[] }>("sketch", {
                sketch: writtenSketch(sketch),
            });
            const geometry = await this.app.engine.blob(key);
            if (mine === this.requestCount) {
                this.fits.value = branches;
                this.errorText.value = "";
                this.tree.show(geometry);
            }
        } catch (error) {
            if (mine === this.requestCount) {
                this.errorText.value = (error as Error).message;
                this.tree.clear();
            }
        } finally {
            this.isRequesting = false;
        }
        if (mine !== this.requestCount) {
            await this.rebuild();
        }
    }

    /** Shows in another view where objects at a pixel of this view can be. */
    lookAlong(view: SketchView, at: Pixel): void {
        const other = this.sketch.peek().views.find(({ name }) => name !== view.name);
        if (!other) {
            return;
        }
        const level = levelIn(view, other, at);
        if (level === null) {
            this.looked = { view, other, at };
            void this.requestLine();
            return;
        }
        const points: Pixel[] = [
            [-1e4, level],
            [1e4, level],
        ];
        this.line.value = { view: other.name, points };
    }

    /** The pointer has left the pane. */
    lookAway(): void {
        this.looked = null;
        this.line.value = null;
    }

    // One at a time: the newest position of the pointer is requested afterwards.
    private async requestLine(): Promise<void> {
        if (this.isRequestingLine) {
            return;
        }
        this.isRequestingLine = true;
        while (this.looked) {
            const requestCount = this.looked;
            const line = await this.lineOf(requestCount);
            this.line.value = this.looked && line;
            this.looked = this.looked === requestCount ? null : this.looked;
        }
        this.isRequestingLine = false;
    }

    private async lineOf({ view, other, at }: Looked): Promise<{ view: string; points: readonly Pixel[] } | null> {
        try {
            const fields = { sketch: writtenSketch(this.sketch.peek()), view: view.name, point: at, other: other.name };
            const { line } = await this.app.engine.request<{ line: Pixel[] }>("epipolar", fields);
            return { view: other.name, points: line };
        } catch {
            return null; // incomplete cameras; the sketch reports them itself
        }
    }

    /** Requests strokes from the silhouettes in the images. */
    async trace(): Promise<void> {
        try {
            const { sketch } = await this.app.engine.request<{ sketch: Sketch }>("trace", {
                sketch: writtenSketch({ ...this.sketch.peek(), branches: [] }),
            });
            await this.layOut(readSketch(JSON.stringify(sketch)));
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
        }
    }

    async loadPicture(image: string): Promise<ImageBitmap | null> {
        const known = this.pictures.peek().get(image);
        if (known) {
            return known;
        }
        try {
            const picture = await createImageBitmap(await this.app.engine.file(image));
            this.pictures.value = new Map([...this.pictures.peek(), [image, picture]]);
            return picture;
        } catch (error) {
            this.app.store.notify(`The image ${image} cannot be shown: ${(error as Error).message}`, "error");
            return null;
        }
    }

    /** Sets an image of the folder as the background of a view. */
    async setPicture(index: number, image: string): Promise<void> {
        const picture = await this.loadPicture(image);
        if (picture) {
            this.set(changeView(this.sketch.peek(), index, withPicture(this.sketch.peek().views[index], image, picture)));
            await this.rebuild();
        }
    }

    /** Copies an image into the folder and uses it. */
    async addPicture(index: number, file: File): Promise<void> {
        try {
            await this.list();
            if (!this.files.peek().includes(file.name)) {
                await this.app.engine.upload(file.name, file);
                await this.list();
            }
            await this.setPicture(index, file.name);
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
        }
    }

    /** Shows another sketch with its images. */
    async layOut(sketch: Sketch): Promise<void> {
        this.set(sketch);
        this.chosen.value = null;
        await Promise.all(sketch.views.map(({ image }) => (image ? this.loadPicture(image) : null)));
        await this.rebuild();
    }

    async open(file: string): Promise<void> {
        try {
            const text = await (await this.app.engine.file(file)).text();
            this.name.value = file.replace(/^.*\//, "").replace(/\.sketch\.json$/, "");
            await this.layOut(readSketch(text));
        } catch (error) {
            this.app.store.notify((error as Error).message, "error");
        }
    }

    /** Writes the sketch file and runs its command; if the scene already contains it, the command is run again. */
    async commit(): Promise<boolean> {
        const { engine, store } = this.app;
        const name = this.name.peek();
        const file = `${name}.sketch.json`;
        const text = JSON.stringify(writtenSketch(this.sketch.peek()), null, 1);
        try {
            await engine.upload(file, new Blob([text], { type: "application/json" }), true);
            const line = commandLine(["sketch", name, file]);
            if (store.state.peek().statements.some((statement) => statement.text.trim() === line)) {
                await engine.request("rerun", { file });
            } else if ((await runLine(this.app, line)) === null) {
                return false;
            }
        } catch (error) {
            store.notify((error as Error).message, "error");
            return false;
        }
        this.tree.clear();
        store.selection.value = { ...store.selection.peek(), object: { kind: "skeleton", name }, nodes: [] };
        return true;
    }
}
