// What is typed and not yet in the document, kept by the browser for as long as its tab lives: it is there again after a reload, or a crash.

export interface Draft {
    base: string; // the text of the document that it was made of
    text: string;
}

const keyOf = (folder: string) => `coppice.draft ${folder}`;

/** Keeps what is typed in the scene of a folder; nothing where it is null. */
export function keepDraft(folder: string, draft: Draft | null): void {
    try {
        if (draft) {
            sessionStorage.setItem(keyOf(folder), JSON.stringify(draft));
        } else {
            sessionStorage.removeItem(keyOf(folder));
        }
    } catch {
        // there is no room, or none is given: then it lasts as long as the page
    }
}

export function keptDraft(folder: string): Draft | null {
    try {
        return JSON.parse(sessionStorage.getItem(keyOf(folder)) ?? "null") as Draft | null;
    } catch {
        return null;
    }
}
