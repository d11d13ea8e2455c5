// The objects of the document in the view: fetches changed geometry and draws previews.
import * as THREE from "three";
import type { Engine, Geometry, Store } from "../app";
import { EngineError } from "../app";
import type { GeometryHeader, Kind, ObjectName, SceneObject } from "../protocol";
import type { Range } from "./colors";
import type { Display } from "./display";
import { Fetcher } from "./fetcher";
import { Materials } from "./materials";
import { keyOf, type Look, ObjectView, type Slot } from "./object_view";
import { meshSources } from "./sources";
import { requestedColor, union } from "./values";

const kStaleWait = 200; // [ms] maximum delay of a surface after its skeleton before capsules replace it
const kMaxFollowed = 3000; // maximum number of nodes of a skeleton with a surface that follows every preview

const kSlotOf: Record<GeometryHeader["kind"], Slot> = {
    surface: "surface",
    patch: "surface",
    skeleton: "axes",
    points: "points",
    curve: "curve",
};

// Materials have no shape.
const kSlotOfKind: Record<Exclude<Kind, "material">, Slot> = {
    solid: "surface",
    mesh: "surface",
    skeleton: "axes",
    points: "points",
    path: "curve",
    profile: "curve",
};

interface Entry {
    shown: ObjectView;
    requested: Map<Slot, string>; // last request for each slot, received or pending
    surfaceOf: number; // version of the object that the drawn surface shows
    dressed: number; // number of surfaces for which images were requested
    timer: ReturnType<typeof setTimeout> | undefined;
}

interface Order {
    entry: Entry;
    object: SceneObject;
    slot: Slot;
    fields: Record<string, unknown>; // fields of the `show` request
    urgent: boolean;
    then?(): void;
}

export class Objects {
    readonly group = new THREE.Group();
    private readonly entries = new Map<string, Entry>();
    private readonly fetcher: Fetcher;
    private readonly materials: Materials;
    private readonly held = new Set<string>(); // slots with the geometry of a preview
    private readonly reported = new Set<string>(); // errors that were already reported

    constructor(
        private readonly store: Store,
        engine: Engine,
        private readonly display: Display,
        private readonly look: () => Look,
        private readonly changed: () => void,
    ) {
        this.fetcher = new Fetcher(engine);
        this.materials = new Materials(engine);
    }

    shown(object: ObjectName): ObjectView | undefined {
        return this.entries.get(keyOf(object))?.shown;
    }

    all(): ObjectView[] {
        return [...this.entries.values()].map((entry) => entry.shown);
    }

    /** The common range of the coloured values of all objects. */
    range(): Range | null {
        const color = this.display.color.peek();
        return this.all().reduce<Range | null>((range, shown) => union(range, shown.range(color)), null);
    }

    /** Updates the view to the state of the document. */
    sync(): void {
        const hidden = this.store.hidden.peek();
        const wanted = this.store.state.peek().objects.filter((object) => !hidden.has(keyOf(object)));
        const keys = new Set(wanted.map(keyOf));
        for (const [key, entry] of this.entries) {
            if (!keys.has(key) && !this.held.has(key)) {
                this.remove(key, entry);
            }
        }
        for (const object of wanted) {
            if (!this.held.has(keyOf(object))) {
                this.requestGeometry(object);
            }
        }
        this.cover();
        this.changed();
    }

    /** Ends the previews; the document has the current state. */
    settle(): void {
        this.held.clear();
        this.sync();
    }

    setResting(resting: boolean): void {
        this.fetcher.setResting(resting);
    }

    get busy(): boolean {
        return this.fetcher.busy || this.materials.busy;
    }

    /** Receives geometry of a preview or of its end. */
    receive(geometry: Geometry): void {
        const { object, kind, seq } = geometry.header;
        const key = keyOf(object);
        if (this.store.hidden.peek().has(key)) {
            return;
        }
        const entry = this.entry(object);
        const slot = kSlotOf[kind];
        const inScene = this.store.find(object.kind, object.name);
        this.fetcher.drop(`${key}/${slot}`);
        if (seq !== undefined) {
            this.held.add(key);
            entry.requested.delete(slot);
            this.cover();
        }
        if (kind !== "patch") {
            entry.shown.put(slot, geometry, this.look());
            if (geometry.header.images) {
                void this.dress(entry, object, geometry);
            }
        } else if (!entry.shown.patch(geometry, this.look())) {
            entry.requested.delete("surface"); // based on a state that the page does not have
            return;
        }
        if (slot === "surface" && object.kind === "skeleton") {
            entry.surfaceOf = seq === undefined ? (inScene?.version ?? -1) : -1;
            this.markCurrent(entry);
        } else if (slot === "axes") {
            this.scheduleStale(entry, seq === undefined ? kStaleWait : kStaleWait / 4);
        }
    }

    /** Fields of a preview about an object. */
    follows(about?: ObjectName): Record<string, unknown> {
        const entry = about && this.entries.get(keyOf(about));
        const nodes = entry?.shown.geometries.get("axes")?.arrays.parent.length ?? Infinity;
        if (about?.kind !== "skeleton" || this.display.skeletons.peek() !== "surface" || nodes > kMaxFollowed) {
            return {};
        }
        const { surface } = entry?.shown ?? {};
        return surface?.color === "plain" ? { surface: {}, have: surface.version } : { surface: {} };
    }

    /** Redraws after a change of the settings. */
    redraw(): void {
        for (const { shown } of this.entries.values()) {
            shown.redraw(this.look());
        }
        this.sync();
    }

    apply(): void {
        this.cover();
        for (const { shown } of this.entries.values()) {
            shown.apply(this.look());
        }
    }

    private entry(object: ObjectName): Entry {
        const key = keyOf(object);
        let entry = this.entries.get(key);
        if (!entry) {
            const shown = new ObjectView({ kind: object.kind, name: object.name }, this.changed);
            entry = { shown, requested: new Map(), surfaceOf: -1, dressed: 0, timer: undefined };
            this.entries.set(key, entry);
            this.group.add(shown.group);
        }
        return entry;
    }

    private remove(key: string, entry: Entry): void {
        clearTimeout(entry.timer);
        this.fetcher.drop(`${key}/`);
        entry.shown.dispose();
        this.entries.delete(key);
    }

    private requestGeometry(object: SceneObject): void {
        if (object.kind === "material") {
            return;
        }
        const entry = this.entry(object);
        const slot = kSlotOfKind[object.kind];
        const color = this.display.color.peek();
        if (object.kind === "solid") {
            this.order(entry, object, slot, { form: "coarse" }, true, () => this.order(entry, object, slot, { form: "fine" }, false));
        } else if (object.kind === "skeleton") {
            this.order(entry, object, slot, { form: "axes", color: requestedColor(color, "axes") }, true);
            if (object.count > kMaxFollowed && this.hasMesh(object)) {
                this.forget(entry, "surface"); // previews could not show it either
            } else {
                this.requestSurface(entry, object);
            }
            if (this.display.cage.peek()) {
                this.order(entry, object, "cage", { form: "cage" }, false);
            } else {
                this.forget(entry, "cage");
            }
        } else {
            const form = object.kind === "mesh" ? "surface" : slot === "curve" ? "curve" : "points";
            this.order(entry, object, slot, { form }, true);
        }
    }

    private requestSurface(entry: Entry, object: SceneObject): void {
        if (this.display.skeletons.peek() !== "surface") {
            this.forget(entry, "surface");
            return;
        }
        const color = requestedColor(this.display.color.peek(), "surface");
        const { surface } = entry.shown;
        const have = surface?.color === "plain" && color === "plain" ? { have: surface.version } : {};
        const fields = { form: "surface", surface: {}, color, ...have };
        if (entry.surfaceOf === object.version && surface?.color === color) {
            entry.requested.set("surface", this.requestKey(object, { form: "surface", color }));
        }
        this.order(entry, object, "surface", fields, false);
        if (entry.surfaceOf !== object.version) {
            this.scheduleStale(entry, kStaleWait);
        }
    }

    /** Whether the mesh of a skeleton can be shown in its place. */
    private hasMesh(skeleton: SceneObject): boolean {
        const hidden = this.store.hidden.peek();
        return this.isPlain() && [...meshSources(this.store)].some(([mesh, source]) => source === skeleton.name && !hidden.has(`mesh:${mesh}`));
    }

    private isPlain(): boolean {
        return requestedColor(this.display.color.peek(), "surface") === "plain" && this.display.skeletons.peek() === "surface";
    }

    // A skeleton and its mesh are the same tree: only one of them is drawn.
    private cover(): void {
        const look = this.look();
        const sources = meshSources(this.store);
        const covered = new Set<Entry>();
        for (const mesh of this.entries.values()) {
            const { shown } = mesh;
            if (shown.object.kind === "mesh") {
                const source = sources.get(shown.object.name);
                const skeleton = this.entries.get(`skeleton:${source}`);
                shown.isWood = source !== undefined;
                shown.source = skeleton?.shown ?? null;
                if (skeleton) {
                    covered.add(this.replaces(mesh, skeleton, look) ? skeleton : mesh);
                }
            }
        }
        for (const entry of this.entries.values()) {
            entry.shown.setCovered(covered.has(entry), look);
        }
    }

    // The mesh is drawn unless it is older than the skeleton or too slow to move.
    private replaces(mesh: Entry, skeleton: Entry, look: Look): boolean {
        const isNew = mesh.surfaceOf === this.store.find("mesh", mesh.shown.object.name)?.version && !this.held.has(keyOf(skeleton.shown.object));
        return this.isPlain() && isNew && !mesh.shown.isTooSlow(look);
    }

    private forget(entry: Entry, slot: Slot): void {
        this.fetcher.drop(`${keyOf(entry.shown.object)}/${slot}`);
        entry.requested.delete(slot);
        entry.shown.drop(slot);
        entry.surfaceOf = slot === "surface" ? -1 : entry.surfaceOf;
    }

    private requestKey(object: SceneObject, fields: Record<string, unknown>): string {
        return `${object.version} ${fields.form} ${fields.color ?? ""}`;
    }

    private order(entry: Entry, object: SceneObject, slot: Slot, fields: Record<string, unknown>, urgent: boolean, then?: () => void): void {
        const requestKey = this.requestKey(object, fields);
        const requested = entry.requested.get(slot);
        if (requested === requestKey || (fields.form === "coarse" && requested === this.requestKey(object, { form: "fine" }))) {
            return;
        }
        entry.requested.set(slot, requestKey);
        this.fetch({ entry, object, slot, fields, urgent, then });
    }

    private fetch(order: Order): void {
        const { entry, object, slot, fields, urgent, then } = order;
        this.fetcher.order({
            slot: `${keyOf(object)}/${slot}`,
            urgent,
            fields: { kind: object.kind, name: object.name, ...fields },
            done: (geometry) => {
                if (geometry) {
                    geometry.header.color = fields.color as string | undefined;
                }
                this.arrived(entry, object, slot, geometry);
                then?.();
            },
            failed: (error) => this.failed(order, error),
        });
    }

    private arrived(entry: Entry, object: SceneObject, slot: Slot, geometry: Geometry | null): void {
        if (geometry?.header.kind === "patch" && !entry.shown.patch(geometry, this.look())) {
            entry.shown.drop("surface"); // the state differs from the one in the request; request the whole surface
            entry.requested.delete(slot);
            this.requestSurface(entry, object);
            return;
        }
        if (geometry && geometry.header.kind !== "patch") {
            entry.shown.put(slot, geometry, this.look());
        }
        if (slot === "surface") {
            entry.surfaceOf = object.version;
            this.markCurrent(entry);
            this.cover();
        }
        if (slot === "surface" && geometry) {
            void this.dress(entry, object, geometry);
        }
        this.changed();
    }

    // The images are requested for each version of a mesh; those that it has already are kept until then.
    private async dress(entry: Entry, object: ObjectName, geometry: Geometry): Promise<void> {
        const turn = ++entry.dressed;
        try {
            const { images: keys } = geometry.header;
            const images = !geometry.arrays.uv ? null : await (keys ? this.materials.takeImages(keys) : this.materials.take(object.name));
            if (this.entries.get(keyOf(object)) === entry && entry.dressed === turn) {
                entry.shown.dress(images, this.look());
            } else {
                images?.release(); // a newer surface requests its own
            }
        } catch (error) {
            this.complain(object, "cannot be shown with its material", error as Error);
        }
    }

    private failed(order: Order, error: Error): void {
        const { entry, object, slot, fields } = order;
        const now = this.store.find(object.kind, object.name);
        const isPassing = error instanceof EngineError && ["busy", "cancelled", "files"].includes(error.kind);
        if (now?.version !== object.version || isPassing) {
            entry.requested.delete(slot); // the next state repeats the request
            return;
        }
        this.complain(object, "cannot be shown with these settings", error);
        if ((fields.color ?? "plain") !== "plain") {
            this.fetch({ ...order, fields: { ...fields, color: "plain" } }); // the fallback is a view without colours
        }
    }

    // Reports a fault of an object once.
    private complain({ kind, name }: ObjectName, fault: string, { message }: Error): void {
        const complaint = `The ${kind} ${name} ${fault}: ${message}`;
        if (!this.reported.has(complaint)) {
            this.reported.add(complaint);
            this.store.notify(complaint, "warning");
        }
    }

    private markCurrent(entry: Entry): void {
        clearTimeout(entry.timer);
        entry.timer = undefined;
        entry.shown.setStale(false, this.look());
    }

    // Capsules replace a surface that does not arrive soon.
    private scheduleStale(entry: Entry, wait: number): void {
        if (entry.shown.surface && entry.timer === undefined) {
            entry.timer = setTimeout(() => {
                entry.timer = undefined;
                entry.shown.setStale(true, this.look());
            }, wait);
        }
    }
}
