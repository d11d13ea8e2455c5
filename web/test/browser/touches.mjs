// Touch input for the browser, like events of the system.
const kSessions = new WeakMap();

async function send(page, type, places) {
    if (!kSessions.has(page)) {
        kSessions.set(page, await page.context().newCDPSession(page));
    }
    const touchPoints = places.map(({ x, y }, id) => ({ x, y, id }));
    await kSessions.get(page).send("Input.dispatchTouchEvent", { type, touchPoints });
}

export const down = (page, ...places) => send(page, "touchStart", places);
export const move = (page, ...places) => send(page, "touchMove", places);
export const up = (page, ...left) => send(page, "touchEnd", left);

const between = (a, b, share) => ({ x: a.x + (b.x - a.x) * share, y: a.y + (b.y - a.y) * share });

/** Moves pressed fingers from positions to others, in steps. */
export async function moveFinger(page, from, to, steps = 6) {
    for (let n = 1; n <= steps; ++n) {
        await move(page, ...from.map((place, finger) => between(place, to[finger], n / steps)));
    }
}

/** Draws with one finger along positions of the page; `during` is called before it is lifted. */
export async function drag(page, places, { during, steps = 5 } = {}) {
    await down(page, places[0]);
    for (const [n, place] of places.slice(1).entries()) {
        await moveFinger(page, [places[n]], [place], steps);
    }
    await during?.();
    await up(page);
}

/** Two fingers that move from two positions to two others. */
export async function pinch(page, from, to) {
    await down(page, from[0]);
    await down(page, ...from);
    await moveFinger(page, from, to);
    await up(page);
}

export async function tapAt(page, place) {
    await down(page, place);
    await up(page);
}
