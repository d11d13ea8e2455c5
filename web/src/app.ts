// Interfaces between the components of the page. transport.ts, store.ts and view/ implement them; tools/ and panels/ use them.
import type { Signal } from "@preact/signals-core";
import type { VNode } from "preact";
import type * as THREE from "three";
import type { Command, ErrorKind, GeometryHeader, Grown, Kind, ObjectName, Point, SceneObject, State } from "./protocol";
import type { Display } from "./view/display";

export interface Geometry {
    header: GeometryHeader;
    arrays: Record<string, Float32Array | Uint32Array | Uint16Array | Uint8Array | Int8Array>;
}

export class EngineError extends Error {
    constructor(
        message: string,
        readonly kind: ErrorKind,
    ) {
        super(message);
    }
}

export interface Ran {
    statement: number; // its number
    message: string;
    names: string[]; // chosen by the engine for the new objects of the line: newName() in tools/kit/words.ts
}

// The connection to the engine: a server now, possibly a worker later.
export interface Engine {
    readonly client: string; // name of this tab in STATE.by
    request<Reply = Record<string, unknown>>(type: string, fields?: Record<string, unknown>): Promise<Reply>;
    run(line: string, about?: ObjectName): Promise<Ran>;
    // One at a time: during a preview the newest request waits, and an earlier waiting request is dropped (false). The view
    // receives the geometry of the changed objects automatically.
    preview(line: string, about?: ObjectName, surface?: Record<string, unknown>): Promise<boolean>;
    endPreview(): Promise<void>;
    cancel(): void;
    blob(key: string, stop?: AbortSignal): Promise<Geometry>;
    image(key: string): Promise<Blob>; // PNG or JPEG
    file(name: string): Promise<Blob>;
    upload(name: string, data: Blob, overwrite?: boolean): Promise<{ file: string; bytes: number }>;
}

export interface Selection {
    object: ObjectName | null;
    nodes: number[]; // stable ids of the nodes of a skeleton
    extent: "node" | "branch" | "subtree" | "tree" | "connected"; // the nodes selected with each; connected: from fork to fork
}

export interface Message {
    level: "info" | "warning" | "error";
    text: string;
}

export type Connection = "connecting" | "ready" | "lost" | "refused"; // refused: no further attempt to connect

export interface Store {
    state: Signal<State>;
    schema: Signal<Command[]>; // commands of scenes; empty until they are loaded
    connection: Signal<Connection>;
    folder: Signal<string>; // path of the open folder
    progress: Signal<{ statement: number | null; fraction: number } | null>; // null: of a request that does not belong to the document
    grown: Signal<Grown | null>; // result so far of the current or the last growth
    keepsGrowthPreview: Signal<boolean>; // the result remains in the view after a stop, until the user keeps or discards it
    selection: Signal<Selection>;
    hover: Signal<Pick | null>;
    hidden: Signal<ReadonlySet<string>>; // "kind:name"
    hideFor(objects: readonly ObjectName[], by: ObjectName): void; // hides objects as long as another object exists
    tool: Signal<string>; // id of the active tool
    messages: Signal<Message[]>; // in order, the newest last
    notify(text: string, level?: Message["level"]): void;
    find(kind: Kind, name: string): SceneObject | undefined;
    freeName(base: string): string; // first of base, base2, ... that is not the name of an object
}

// The object at a point of the view.
export interface Pick {
    object: ObjectName;
    point: Point; // [m] in the scene
    node?: number; // stable id: of a skeleton or its surface, the node of the segment
    index?: number; // index of a point of a set, or of a control point of a curve
}

export interface Ray {
    origin: Point;
    direction: Point; // unit vector
}

// Text at a position in the view.
export interface Label {
    at: Point;
    text: string;
    style?: "faint" | "strong";
}

export interface View {
    readonly overlay: THREE.Group; // parent of the objects that tools draw
    readonly display: Display; // display mode and the meaning of colours
    camera(): THREE.Camera;
    requestDraw(): void;
    pick(x: number, y: number, kinds?: Kind[]): Pick | null; // pixels from the upper left corner of the view
    ray(x: number, y: number): Ray;
    toPixels(point: Point): [number, number, number]; // x, y, depth in [-1, 1]
    pixelSize(point: Point): number; // [m] size of a pixel at that depth
    toPlane(x: number, y: number, through: Point, normal?: Point): Point | null; // normal: default is the line of sight
    geometry(object: ObjectName, kind?: GeometryHeader["kind"]): Geometry | undefined; // last received geometry, including previews
    receive(geometry: Geometry): void; // draws it; with `seq` it replaces the geometry of the document until `settle`
    settle(): void;
    frame(objects?: ObjectName[]): void;
    frameAround(place: Point, radius: number): void;
    setLabels(owner: string, labels: readonly Label[]): void; // replaces the labels of the owner
    look(from: "front" | "back" | "left" | "right" | "top" | "bottom" | "free"): void;
    setOrbit(enabled: boolean): void; // tools with a drag disable it
    element(): HTMLCanvasElement;
}

export interface ToolPointer {
    phase: "down" | "move" | "up" | "cancel";
    x: number;
    y: number;
    buttons: number;
    pressure: number; // in [0, 1]; 0.5 for a mouse
    type: "mouse" | "touch" | "pen";
    shift: boolean;
    control: boolean;
    alt: boolean;
}

// An interactive operation in the 3D view. One tool is active at a time; "select" if no other is.
export interface Tool {
    id: string;
    label: string;
    group: "view" | "crown" | "points" | "branch" | "compose";
    help: string; // one sentence
    shortcut?: string; // "G", "Shift+D"
    enabled?(app: App): boolean; // depends on the selection
    start(app: App): ToolRun;
}

export interface ToolRun {
    pointer?(event: ToolPointer): boolean; // true: the event was used, and the view does not orbit
    wheel?(delta: number, event: ToolPointer): boolean;
    key?(event: KeyboardEvent): boolean; // every gesture has a typed equivalent: numbers, Enter, Esc
    panel?(): VNode; // its parameters
    status?(): string; // one line for the status bar
    stop(): void; // Esc or another tool: discards the unfinished operation
}

export interface Panel {
    id: string;
    title: string;
    side: "left" | "right" | "bottom";
    order: number;
    suits?(app: App): boolean; // whether the group is open by default, unless the user has changed it; if undefined, always
    render(app: App): VNode;
}

export interface App {
    engine: Engine;
    store: Store;
    view: View;
    tools: Tool[];
    panels: Panel[];
    take(tool: string): void; // by id; "select" deactivates the current tool
    menuCommand(id: string, run: () => void): void; // commands of the page itself, for the menu file and shortcuts: "frame", "undo"
    command(id: string): void; // runs one of them
}
