// Parameters that the program passes to the page in its address: #token=...&import=tree.ply

export interface AddressParameters {
    token: string;
    firstFile: string; // file of the folder that is opened first; empty: no file
}

function decoded(text: string): string {
    try {
        return decodeURIComponent(text);
    } catch {
        return text; // such a file does not exist, which is reported later
    }
}

/**
 * Returns the parameters in the address and removes them, so that a reload does not repeat the import; the token is stored for
 * this tab.
 */
export function consumeAddress(location: Location, history: History, kept: Storage): AddressParameters {
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
