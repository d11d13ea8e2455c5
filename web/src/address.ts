// What the program tells the page by the address that it opens: #token=...&import=tree.ply

export interface Told {
    token: string;
    firstFile: string; // of the folder, to begin with; empty where none is
}

function decoded(text: string): string {
    try {
        return decodeURIComponent(text);
    } catch {
        return text; // there is no such file, which is said then
    }
}

/** What the address tells. It forgets that, so that a tab that is loaded again does nothing twice; the token is kept for that tab. */
export function takeAddress(location: Location, history: History, kept: Storage): Told {
    const token = /(?:^#|&)token=([A-Za-z0-9_-]+)/.exec(location.hash)?.[1] ?? /^#([A-Za-z0-9_-]{16,})$/.exec(location.hash)?.[1];
    const file = /(?:^#|&)import=([^&]+)/.exec(location.hash)?.[1] ?? "";
    if (token) {
        kept.setItem("token", token);
    }
    if (token || file) {
        history.replaceState(null, "", location.pathname + location.search);
    }
    return { token: token ?? kept.getItem("token") ?? "", firstFile: decoded(file) };
}
