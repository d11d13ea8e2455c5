// The 3D view: draws the objects of the document on demand.
import { effect } from "@preact/signals-core";
import * as THREE from "three";
import type { Geometry, Label, Pick, Ray, Store, ToolPointer, View } from "../app";
import type { ActiveTool } from "../active_tool";
import type { GeometryHeader, Kind, ObjectName, Point } from "../protocol";
import type { Transport } from "../transport";
import { Navigation } from "./camera/navigate";
import { between, type Pose, Rig, type Side } from "./camera/rig";
import type { Range } from "./colors";
import { CrossingMarks } from "./crossing_marks";
import { createDisplay } from "./display";
import { Glow } from "./glow";
import { GrowthPreview } from "./growth_preview";
import { Labels } from "./labels";
import { roundBelow } from "./lengths";
import { Objects } from "./objects";
import { pickAt } from "./picking/picker";
import { SectionPlane } from "./section";
import { keyOf, type Look } from "./object_view";
import { FieldSlice } from "./slice";
import { Stage } from "./stage";
import { kDark, kLight, type Theme } from "./theme";
import { kMeanings } from "./values";

const kRest = 250; // [ms] time without movement after which deferred work is done
const kLongRest = 500; // [ms] the same for slow work
const kGlide = 220; // [ms] duration of a camera transition
const kSlow = 45; // [ms] delay of a frame above which a moving view is drawn in a simpler form
const kScaleBar = 150; // [px] maximum length

export class View3D implements View {
    readonly overlay = new THREE.Group();
    readonly display = createDisplay();
    readonly rig = new Rig();
    private readonly canvas = document.createElement("canvas");
    private readonly renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, powerPreference: "high-performance" });
    private readonly scene = new THREE.Scene();
    private readonly stage = new Stage(this.scene);
    private readonly section = new SectionPlane();
    private readonly wire = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 });
    private readonly faintWire = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.16, depthWrite: false });
    private readonly glow: Glow;
    private readonly objects: Objects;
    private readonly grown: GrowthPreview;
    private readonly slice: FieldSlice;
    private readonly crossings = new CrossingMarks();
    private readonly labels = new Labels();
    private readonly lost = document.createElement("p"); // message shown when the WebGL context is lost
    private readonly navigation: Navigation;
    private readonly box = new THREE.Box3(); // of all visible objects
    private readonly around = new THREE.Sphere(new THREE.Vector3(0, 0, 2), 5); // of the same
    private activeTool: ActiveTool | null = null;
    private theme: Theme = kDark;
    private isRequested = false;
    private isPlainer = false;
    private isTurning = false; // the camera is moving or moved very recently
    private restTimer: ReturnType<typeof setTimeout> | undefined;
    private hoverAt: [number, number] | null = null;
    private slowWith = Infinity; // number of triangles that was too slow to move completely
    private isClear = true; // solids are transparent
    private isFramed = false;
    private isChosen = false; // the user has moved the camera: it keeps its position
    private isTraced = false;
    /** Counts the drawn frames; for tests. */
    readonly drawn = { frames: 0 };

    constructor(
        private readonly store: Store,
        engine: Transport,
    ) {
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("role", "application");
        this.canvas.setAttribute("aria-label", "View of the scene. Arrow keys rotate it, with Shift they move it; plus and minus zoom.");
        this.renderer.toneMapping = THREE.NeutralToneMapping;
        this.renderer.localClippingEnabled = true;
        this.renderer.shadowMap.enabled = true;
        this.renderer.shadowMap.type = THREE.PCFShadowMap;
        this.renderer.shadowMap.autoUpdate = false;
        this.objects = new Objects(
            store,
            engine,
            this.display,
            () => this.look_(),
            () => this.changed(),
        );
        this.grown = new GrowthPreview(engine, () => this.requestDraw());
        this.glow = new Glow(store, (object) => this.geometry(object, "skeleton"));
        this.slice = new FieldSlice(engine, store, this.display, () => this.requestDraw());
        this.scene.add(this.objects.group, this.grown.group, this.slice.group, this.section.group, this.glow.group);
        this.scene.add(this.crossings.group, this.overlay);
        this.navigation = new Navigation(this.navigated(), () => this.activeTool);
        this.followScheme();
        this.followSignals();
        this.followContext();
    }

    attach(holder: HTMLElement): void {
        holder.append(this.canvas, this.labels.element, this.lost);
        new ResizeObserver(() => this.resize(holder)).observe(holder);
    }

    listenTo(activeTool: ActiveTool): void {
        this.activeTool = activeTool;
    }

    receive(geometry: Geometry): void {
        this.objects.receive(geometry);
    }

    follows(about?: ObjectName): Record<string, unknown> {
        return this.objects.follows(about);
    }

    /** Ends the previews: the document is drawn when its next state arrives. */
    settle(): void {
        setTimeout(() => this.objects.settle(), 30);
    }

    showGrown(key: string): void {
        this.grown.show(key, this.theme);
    }

    key(event: KeyboardEvent): boolean {
        return this.navigation.key(event);
    }

    camera(): THREE.Camera {
        return this.rig.camera;
    }

    requestDraw(): void {
        if (!this.isRequested) {
            this.isRequested = true;
            const now = performance.now();
            requestAnimationFrame(() => this.draw(performance.now() - now));
        }
    }

    pick(x: number, y: number, kinds?: Kind[]): Pick | null {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const picture = { rig: this.rig, section: this.section, width, height, glass: this.isGlass() };
        return pickAt(picture, this.threeRay(x, y), this.objects.all(), x, y, kinds);
    }

    ray(x: number, y: number): Ray {
        const { origin, direction } = this.threeRay(x, y);
        return { origin: origin.toArray(), direction: direction.toArray() };
    }

    toPixels(point: Point): [number, number, number] {
        const at = new THREE.Vector3(...point).project(this.rig.camera);
        return [((at.x + 1) / 2) * this.canvas.clientWidth, ((1 - at.y) / 2) * this.canvas.clientHeight, at.z];
    }

    pixelSize(point: Point): number {
        return this.rig.pixelSize(this.rig.depth(new THREE.Vector3(...point)));
    }

    toPlane(x: number, y: number, through: Point, normal?: Point): Point | null {
        const facing = normal ? new THREE.Vector3(...normal).normalize() : this.rig.forward();
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, new THREE.Vector3(...through));
        return this.threeRay(x, y).intersectPlane(plane, new THREE.Vector3())?.toArray() ?? null;
    }

    geometry(object: ObjectName, kind?: GeometryHeader["kind"]): Geometry | undefined {
        const all = this.objects.shown(object)?.geometries;
        return [...(all?.values() ?? [])].find((one) => kind === undefined || one.header.kind === kind);
    }

    frame(objects?: ObjectName[]): void {
        this.isChosen = objects !== undefined;
        this.glide(this.rig.framing(this.boxOf(objects).getBoundingSphere(new THREE.Sphere())));
    }

    frameAround(place: Point, radius: number): void {
        this.glide(this.rig.framing(new THREE.Sphere(new THREE.Vector3(...place), radius)));
    }

    setLabels(owner: string, labels: readonly Label[]): void {
        this.labels.set(owner, labels);
        this.requestDraw();
    }

    look(from: Side | "free"): void {
        if (from === "free") {
            this.display.parallel.value = false;
            return;
        }
        this.glide(this.rig.lookingFrom(from));
    }

    setOrbit(enabled: boolean): void {
        this.navigation.enabled = enabled;
    }

    element(): HTMLCanvasElement {
        return this.canvas;
    }

    /** Whether all requested geometry has been received and drawn. */
    get idle(): boolean {
        return !this.isRequested && !this.objects.busy;
    }

    /** GPU resources of the renderer; for tests of leaks. */
    get memory(): { geometries: number; textures: number } {
        return this.renderer.info.memory;
    }

    private navigated(): ConstructorParameters<typeof Navigation>[0] {
        return {
            rig: this.rig,
            canvas: this.canvas,
            preset: () => this.display.preset.peek(),
            pointUnder: (x, y) => {
                const pick = this.pick(x, y);
                return pick ? new THREE.Vector3(...pick.point) : null;
            },
            hovered: (x, y) => this.hover(x, y),
            own: (event) => this.dragSection(event),
            moved: () => {
                this.isChosen = true;
                this.moved();
            },
            centre: (point) => {
                const { eye, ...rest } = this.rig.pose;
                this.glide({ ...rest, eye: eye.clone().add(point).sub(this.rig.target()) });
            },
        };
    }

    private followScheme(): void {
        const scheme = matchMedia("(prefers-color-scheme: light)");
        const take = () => {
            this.theme = scheme.matches ? kLight : kDark;
            this.stage.setTheme(this.theme);
            this.section.setTheme(this.theme);
            this.slice.setTheme(this.theme);
            this.crossings.setTheme(this.theme);
            this.wire.color.set(this.theme.wire);
            this.faintWire.color.set(this.theme.wire);
            this.glow.setTheme(this.theme);
            this.objects.redraw();
            this.requestDraw();
        };
        scheme.addEventListener("change", take);
        take();
    }

    private followSignals(): void {
        const { store, display } = this;
        effect(() => {
            const { running } = store.state.value;
            void store.hidden.value;
            this.objects.sync();
            this.measureScene();
            if (this.isClear !== this.isGlass()) {
                this.isClear = !this.isClear;
                this.objects.apply(); // the first points in a crown make it transparent
            }
            if (running === null && !store.keepsGrowthPreview.value) {
                this.grown.clear();
            }
        });
        effect(() => {
            void [display.color.value, display.skeletons.value, display.cage.value, display.pointSize.value];
            this.objects.redraw();
        });
        effect(() => {
            void [display.wireframe.value, display.bones.value, display.points.value, display.solids.value, display.grid.value];
            void [display.section.value, display.hour.value, display.north.value, display.shadow.value];
            this.rig.isParallel = display.parallel.value;
            this.isClear = this.isGlass();
            this.objects.apply();
            this.glow.clip(this.look_().clip);
            this.changed();
        });
        effect(() => {
            void [store.selection.value, store.hover.value];
            if (this.glow.update(this.objects.all())) {
                this.requestDraw();
            }
        });
        effect(() => {
            void [display.crossings.value, display.crossing.value];
            this.requestDraw();
        });
    }

    // When the browser restores the context, the renderer restores its resources; the view has to be drawn again.
    private followContext(): void {
        this.lost.className = "picture-lost";
        this.lost.setAttribute("role", "alert");
        this.lost.hidden = true;
        this.canvas.addEventListener("webglcontextlost", () => {
            this.lost.hidden = false;
            this.lost.textContent =
                "The browser has lost the GPU. The view returns as soon as the GPU is available again; otherwise reload the page: the scene is kept.";
        });
        this.canvas.addEventListener("webglcontextrestored", () => {
            this.lost.hidden = true;
            this.changed();
        });
    }

    // Whether solids are transparent.
    private isGlass(): boolean {
        const solids = this.display.solids.peek();
        const { objects, running } = this.store.state.peek();
        const hidden = this.store.hidden.peek();
        const isGrowing = this.store.grown.peek() !== null && (running !== null || this.store.keepsGrowthPreview.peek());
        const hasInside = isGrowing || objects.some((object) => !["solid", "material"].includes(object.kind) && !hidden.has(keyOf(object)));
        return solids === "glass" || (solids === "auto" && hasInside);
    }

    private look_(): Look {
        return {
            display: this.display,
            theme: this.theme,
            glass: this.isGlass(),
            moving: this.isPlainer,
            range: this.objects.range(),
            clip: this.display.section.peek().on ? [this.section.plane] : [],
            wire: this.wire,
            faintWire: this.faintWire,
        };
    }

    // The drawing has changed: update shadows, outlines and legend.
    private changed(): void {
        this.renderer.shadowMap.needsUpdate = true;
        this.isTraced = false;
        this.requestDraw();
    }

    private resize(holder: HTMLElement): void {
        this.rig.resize(holder.clientWidth, holder.clientHeight);
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.renderer.setSize(holder.clientWidth, holder.clientHeight);
        this.requestDraw();
    }

    private boxOf(objects?: ObjectName[]): THREE.Box3 {
        const names = objects && new Set(objects.map(keyOf));
        const box = new THREE.Box3();
        const hidden = this.store.hidden.peek();
        for (const object of this.store.state.peek().objects) {
            const key = keyOf(object);
            const [x0, y0, z0, x1, y1, z1] = object.bounds;
            if ((names ? names.has(key) : !hidden.has(key)) && x1 >= x0) {
                box.expandByPoint(new THREE.Vector3(x0, y0, z0)).expandByPoint(new THREE.Vector3(x1, y1, z1));
            }
        }
        return box.isEmpty() ? new THREE.Box3(new THREE.Vector3(-2, -2, 0), new THREE.Vector3(2, 2, 4)) : box;
    }

    private measureScene(): void {
        this.box.copy(this.boxOf());
        this.box.getBoundingSphere(this.around);
        const objects = this.store.state.peek().objects.filter(({ kind }) => kind !== "material");
        const hidden = this.store.hidden.peek();
        const isSeen = this.rig.sees(this.around);
        const isDrawn = isSeen && this.store.tool.peek() !== "select"; // created by hand where the camera looks: the camera does not move
        const isLost = (!this.isFramed && !isDrawn) || (!this.isChosen && !isSeen);
        if (isLost && objects.some((object) => !hidden.has(keyOf(object)))) {
            this.rig.pose = this.rig.framing(this.around); // the first object is framed, and so is one that grows beyond the view
        }
        this.isFramed = objects.length > 0;
    }

    private threeRay(x: number, y: number): THREE.Ray {
        const at = new THREE.Vector2((x / this.canvas.clientWidth) * 2 - 1, 1 - (y / this.canvas.clientHeight) * 2);
        const caster = new THREE.Raycaster();
        caster.setFromCamera(at, this.rig.camera);
        return caster.ray;
    }

    private moved(): void {
        this.isTurning = true;
        this.objects.setResting(false);
        clearTimeout(this.restTimer);
        this.restTimer = setTimeout(() => this.rest(), this.isPlainer ? kLongRest : kRest);
        this.requestDraw();
    }

    private rest(): void {
        this.objects.setResting(true);
        if (!this.navigation.isMoving) {
            // a pause during a drag is short
            this.isTurning = false;
            if (this.isPlainer) {
                this.setPlainer(false);
                this.requestDraw(); // a change of the pixel ratio clears the canvas
            }
        }
    }

    // The shadows of the resting view are kept.
    private setPlainer(plainer: boolean): void {
        const { shadowMap } = this.renderer;
        const { needsUpdate } = shadowMap;
        this.isPlainer = plainer;
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * (plainer ? 0.6 : 1));
        this.objects.apply();
        shadowMap.needsUpdate = needsUpdate;
    }

    // A number of triangles that was too slow is not tried again. The value is not stored, because the next computer may be
    // faster.
    private noteSpeed(waited: number): void {
        if (this.isTurning && !this.isPlainer) {
            const { triangles } = this.renderer.info.render;
            this.slowWith = waited > kSlow ? Math.min(this.slowWith, triangles) : this.slowWith;
            if (triangles >= this.slowWith) {
                this.setPlainer(true);
            }
        }
    }

    private glide(to: Pose): void {
        const from = this.rig.pose;
        if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
            this.rig.pose = to;
            this.moved();
            return;
        }
        const begun = performance.now();
        const step = (now: number) => {
            const t = Math.min(Math.max((now - begun) / kGlide, 0), 1);
            this.rig.pose = t < 1 ? between(from, to, t * t * (3 - 2 * t)) : to;
            this.moved();
            if (t < 1) {
                requestAnimationFrame(step);
            }
        };
        requestAnimationFrame(step);
    }

    private dragSection(event: ToolPointer): boolean {
        if (event.phase === "down") {
            return this.section.grabs(event.x, event.y, this.toPixels(this.section.middle.toArray()));
        }
        if (event.phase === "move") {
            const { origin, direction } = this.threeRay(event.x, event.y);
            this.display.section.value = this.section.dragged(origin, direction);
        }
        return true;
    }

    // A frame is drawn only if the glow changes.
    private hover(x: number, y: number): void {
        if (!this.hoverAt) {
            requestAnimationFrame(() => this.updateHover());
        }
        this.hoverAt = [x, y];
    }

    private updateHover(): void {
        const at = this.hoverAt;
        this.hoverAt = null;
        if (at && !this.navigation.isMoving) {
            const pick = at[0] < -1e3 ? null : this.pick(...at);
            const last = this.store.hover.peek();
            const isSame = pick?.object === last?.object && pick?.node === last?.node && pick?.index === last?.index;
            if (!isSame || (pick && last && pick.point.some((c, i) => c !== last.point[i]))) {
                this.store.hover.value = pick;
            }
        }
    }

    // The legend shows the meaning of the colours; if it changes, objects are coloured again.
    private updateLegend(): void {
        const meaning = kMeanings[this.display.color.peek()];
        const range: Range | null = meaning ? this.objects.range() : null;
        const before = this.display.legend.peek();
        if (!meaning || !range) {
            this.display.legend.value = null;
        } else if (before?.low !== range.low || before.high !== range.high || before.title !== meaning.title) {
            this.display.legend.value = { ...meaning, ...range };
            this.objects.apply();
        }
    }

    private updateScale(): void {
        const size = this.rig.pixelSize(this.rig.pose.distance);
        const metres = roundBelow(kScaleBar * size);
        const pixels = metres / size;
        const before = this.display.scale.peek();
        if (Math.abs(before.pixels - pixels) > 0.5 || before.metres !== metres) {
            this.display.scale.value = { pixels, metres };
        }
    }

    private updateAxes(): void {
        const [right, up, forward] = [this.rig.right(), this.rig.up(), this.rig.forward()];
        const now = (["x", "y", "z"] as const).map((axis): Point => [right[axis], up[axis], -forward[axis]]);
        const before = this.display.axes.peek();
        if (now.some((axis, i) => axis.some((c, k) => Math.abs(c - (before[i]?.[k] ?? 2)) > 1e-3))) {
            this.display.axes.value = now;
        }
    }

    private showCrossings(): void {
        const isWanted = this.display.color.peek() === "crossings";
        this.crossings.show(isWanted ? this.display.crossings.peek() : [], this.display.crossing.peek());
    }

    private drawSection(): void {
        const section = this.display.section.peek();
        this.section.place(section, this.box);
        if (section.on) {
            this.section.scaleHandle(this.pixelSize(this.section.middle.toArray()));
            if (!this.isTraced) {
                const meshes = this.objects.all().flatMap((shown) => (shown.surface?.group.visible ? [shown.surface.mesh] : []));
                this.section.trace(meshes);
                this.isTraced = true;
            }
        }
    }

    private draw(waited: number): void {
        this.isRequested = false;
        this.noteSpeed(waited);
        const { display, rig, around } = this;
        const seen = around.clone();
        const reach = Math.max(seen.radius, rig.pose.distance * 4);
        rig.apply(new THREE.Sphere(seen.center, reach));
        this.glow.update(this.objects.all());
        this.stage.light(display.hour.peek(), display.north.peek(), display.shadow.peek(), around);
        this.stage.ground(rig.pose.distance, rig.target(), display.grid.peek());
        this.drawSection();
        this.showCrossings();
        this.renderer.render(this.scene, rig.camera);
        ++this.drawn.frames;
        this.labels.place((point) => this.toPixels(point));
        this.updateLegend();
        this.updateScale();
        this.updateAxes();
    }
}
