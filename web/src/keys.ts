// Keyboard shortcuts: their names, and the key events that match them.

/** A command of the page itself, with its id in the menu file. */
export interface Shortcut {
    id: string;
    keys: string[]; // "Ctrl+Z", "F", "Numpad1"; Ctrl is Cmd on a Mac
    label: string;
    always?: true; // also while text is typed
}

export const kShortcuts: Shortcut[] = [
    { id: "undo", keys: ["Ctrl+Z"], label: "Undo" },
    { id: "redo", keys: ["Ctrl+Shift+Z", "Ctrl+Y"], label: "Redo" },
    { id: "open", keys: ["Ctrl+O"], label: "Open a scene", always: true },
    { id: "save", keys: ["Ctrl+S"], label: "Save the scene", always: true },
    { id: "save-as", keys: ["Ctrl+Shift+S"], label: "Save the scene under another name", always: true },
    { id: "import", keys: ["Ctrl+I"], label: "Import files", always: true },
    { id: "export", keys: ["Ctrl+E"], label: "Export objects", always: true },
    { id: "run-to-cursor", keys: ["Ctrl+Enter"], label: "Run the scene to the cursor of its text, or go back to it" },
    { id: "run-all", keys: ["Ctrl+Shift+Enter"], label: "Run the whole scene" },
    { id: "cancel", keys: ["Ctrl+."], label: "Stop the running command" },
    { id: "frame", keys: ["F", "Home"], label: "Frame the selection, or everything" },
    { id: "look-front", keys: ["Numpad1", "Alt+1"], label: "Look from the front" },
    { id: "look-back", keys: ["Ctrl+Numpad1", "Alt+Shift+1"], label: "Look from the back" },
    { id: "look-right", keys: ["Numpad3", "Alt+3"], label: "Look from the right" },
    { id: "look-left", keys: ["Ctrl+Numpad3", "Alt+Shift+3"], label: "Look from the left" },
    { id: "look-top", keys: ["Numpad7", "Alt+7"], label: "Look from above" },
    { id: "look-bottom", keys: ["Ctrl+Numpad7", "Alt+Shift+7"], label: "Look from below" },
    { id: "projection", keys: ["Numpad5", "Alt+5"], label: "Perspective or parallel" },
    { id: "wireframe", keys: ["W"], label: "Wireframe on or off" },
    { id: "hide", keys: ["H"], label: "Hide the selected object" },
    { id: "show-all", keys: ["Alt+H"], label: "Show everything" },
    { id: "delete", keys: ["Delete"], label: "Delete the selected object" },
    { id: "rename", keys: ["F2"], label: "Rename the selected object" },
    { id: "duplicate", keys: ["Shift+D"], label: "Duplicate the selected object" },
    { id: "next-part", keys: ["F6"], label: "To the next part of the page: menu, left panels, view, tools, text, right panels", always: true },
    { id: "part-before", keys: ["Shift+F6"], label: "To the previous part", always: true },
    { id: "menu", keys: ["F10"], label: "The menu; Alt by itself does the same", always: true },
    { id: "shortcuts", keys: ["?"], label: "This table" },
];

/** Returns whether the event matches a shortcut such as "Ctrl+Shift+Z". */
export function matches(shortcut: string, event: KeyboardEvent): boolean {
    const parts = shortcut.split("+");
    const key = parts.pop() ?? "";
    if (parts.includes("Ctrl") !== (event.ctrlKey || event.metaKey) || parts.includes("Alt") !== event.altKey) {
        return false;
    }
    const isMark = key.length === 1 && !/[A-Z0-9.]/.test(key); // the position of "?" and its Shift state depend on the keyboard layout
    if (!isMark && parts.includes("Shift") !== event.shiftKey) {
        return false;
    }
    if (/^[A-Z]$/.test(key)) {
        return event.key.toUpperCase() === key;
    }
    if (/^[0-9]$/.test(key)) {
        return event.code === `Digit${key}`; // Shift changes the character of the key
    }
    return key.startsWith("Numpad") ? event.code === key : event.key === key;
}

/** Whether keys on the element are text, or belong to a widget. */
export function acceptsKeys(target: EventTarget | null): boolean {
    return target instanceof Element && target.closest("input, textarea, select, [contenteditable=true], [role=menu], [role=menubar], dialog") !== null;
}
