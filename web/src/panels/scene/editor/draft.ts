// Typed text that is not yet in the document, stored by the browser as long as the tab exists: it is restored after a reload or a
// crash.

export interface Draft {
    base: string; // the text of the document on which it is based
    text: string;
}

const keyOf = (folder: string) => `coppice.draft ${folder}`;

/** Stores the typed text of the scene of a folder; null removes it. */
export function storeDraft(folder: string, draft: Draft | null): void {
    try {
        if (draft) {
            sessionStorage.setItem(keyOf(folder), JSON.stringify(draft));
        } else {
            sessionStorage.removeItem(keyOf(folder));
        }
    } catch {
        // storage is full or not available: then it is kept as long as the page is open
    }
}

export function storedDraft(folder: string): Draft | null {
    try {
        return JSON.parse(sessionStorage.getItem(keyOf(folder)) ?? "null") as Draft | null;
    } catch {
        return null;
    }
}
