// What the parts of the page know of each other. transport.ts, store.ts and view/ implement it; tools/ and panels/ use it.
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
    constructor(message: string, readonly kind: ErrorKind) {
        super(message);
    }
}

export interface Ran {
    statement: number; // its number
    says: string;
    names: string[]; // that the engine chose for the new objects of the line: newName() in tools/kit/words.ts
}

// The way to the engine: a server today, a worker perhaps one day.
export interface Engine {
    readonly client: string; // name of this tab in STATE.by
    request<Reply = Record<string, unknown>>(type: string, fields?: Record<string, unknown>): Promise<Reply>;
    run(line: string, about?: ObjectName): Promise<Ran>;
    // One at a time: while one is under way, the newest waits and what waited before is dropped (false).
    // The geometry of what it changes reaches the view by itself.
    preview(line: string, about?: ObjectName, surface?: Record<string, unknown>): Promise<boolean>;
    endPreview(): Promise<void>;
    cancel(): void;
    blob(key: string, stop?: AbortSignal): Promise<Geometry>;
    file(name: string): Promise<Blob>;
    upload(name: string, data: Blob, overwrite?: boolean): Promise<{ file: string; bytes: number }>;
}

export interface Selection {
    object: ObjectName | null;
    nodes: number[]; // stable ids of a skeleton's nodes
    extent: "node" | "branch" | "subtree" | "tree" | "connected"; // what is selected with each; connected: from fork to fork
}

export interface Message {
    level: "info" | "warning" | "error";
    text: string;
}

export type Connection = "connecting" | "ready" | "lost" | "refused"; // refused: it does not come back by itself

export interface Store {
    state: Signal<State>;
    schema: Signal<Command[]>; // commands of scenes; empty until known
    connection: Signal<Connection>;
    folder: Signal<string>; // path of the one that is open
    progress: Signal<{ statement: number | null; fraction: number } | null>; // null: of a request beside the document
    grown: Signal<Grown | null>; // so far, of what grows or grew last
    keepsGrown: Signal<boolean>; // it stays in the picture when it was stopped, until it is decided what becomes of it
    selection: Signal<Selection>;
    hover: Signal<Pick | null>;
    hidden: Signal<ReadonlySet<string>>; // "kind:name"
    hideFor(objects: readonly ObjectName[], by: ObjectName): void; // hides objects as long as another one exists
    tool: Signal<string>; // id of the tool in hand
    messages: Signal<Message[]>; // the newest last
    say(text: string, level?: Message["level"]): void;
    find(kind: Kind, name: string): SceneObject | undefined;
    freeName(base: string): string; // base, base2, ... that no object has
}

// What lies under a point of the picture.
export interface Pick {
    object: ObjectName;
    point: Point; // [m] in the scene
    node?: number; // stable id: of a skeleton or its surface, the node whose segment was hit
    index?: number; // of a point of a set, or of a control point of a curve
}

export interface Ray {
    origin: Point;
    direction: Point; // of length 1
}

// Words at a place of the picture.
export interface Label {
    at: Point;
    text: string;
    style?: "faint" | "strong";
}

export interface View {
    readonly overlay: THREE.Group; // of what tools draw
    readonly display: Display; // how it draws, and what its colours stand for
    camera(): THREE.Camera;
    requestDraw(): void;
    pick(x: number, y: number, kinds?: Kind[]): Pick | null; // pixels from the upper left corner of the picture
    ray(x: number, y: number): Ray;
    toPixels(point: Point): [number, number, number]; // x, y, depth in [-1, 1]
    pixelSize(point: Point): number; // [m] a pixel at that depth
    toPlane(x: number, y: number, through: Point, normal?: Point): Point | null; // normal: the line of sight where not given
    geometry(object: ObjectName, kind?: GeometryHeader["kind"]): Geometry | undefined; // as last received, previews included
    receive(geometry: Geometry): void; // draws it; with `seq` in place of what the document has, until `settle`
    settle(): void;
    frame(objects?: ObjectName[]): void;
    frameAround(place: Point, radius: number): void;
    setLabels(owner: string, labels: readonly Label[]): void; // in place of those that the owner had
    look(from: "front" | "back" | "left" | "right" | "top" | "bottom" | "free"): void;
    setOrbit(enabled: boolean): void; // tools that drag switch it off
    element(): HTMLCanvasElement;
}

export interface ToolPointer {
    phase: "down" | "move" | "up" | "cancel";
    x: number;
    y: number;
    buttons: number;
    pressure: number; // in [0, 1]; 0.5 of a mouse
    type: "mouse" | "touch" | "pen";
    shift: boolean;
    control: boolean;
    alt: boolean;
}

// Something that hands do in the 3D view. One is in hand at a time; "select" when no other is.
export interface Tool {
    id: string;
    label: string;
    group: "view" | "crown" | "points" | "branch" | "compose";
    help: string; // one sentence
    shortcut?: string; // "G", "Shift+D"
    enabled?(app: App): boolean; // by selection
    start(app: App): ToolRun;
}

export interface ToolRun {
    pointer?(event: ToolPointer): boolean; // true: taken, the view does not orbit
    wheel?(delta: number, event: ToolPointer): boolean;
    key?(event: KeyboardEvent): boolean; // every gesture has a typed equivalent: numbers, Enter, Esc
    panel?(): VNode; // its parameters
    status?(): string; // one line for the status bar
    stop(): void; // Esc, another tool: takes back what was not ended
}

export interface Panel {
    id: string;
    title: string;
    side: "left" | "right" | "bottom";
    order: number;
    suits?(app: App): boolean; // open at first, and where the user has not said otherwise; always where not given
    render(app: App): VNode;
}

export interface App {
    engine: Engine;
    store: Store;
    view: View;
    tools: Tool[];
    panels: Panel[];
    take(tool: string): void; // by id; "select" puts down what is in hand
    menuCommand(id: string, run: () => void): void; // of the page itself, for the menu file and shortcuts: "frame", "undo"
    command(id: string): void; // runs one of them
}
