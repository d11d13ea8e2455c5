// Whether a tool was activated by a key: then it follows the pointer at once, as in other modellers.
let lastKey = -1;

if (typeof addEventListener === "function") {
    addEventListener(
        "keydown",
        ({ key }) => {
            lastKey = key.length === 1 && key !== " " ? performance.now() : -1; // Enter and the space bar press buttons
        },
        { capture: true },
    );
    addEventListener(
        "pointerdown",
        () => {
            lastKey = -1;
        },
        { capture: true },
    );
}

const kJustNow = 50; // [ms]

export function startedByKey(): boolean {
    return performance.now() - lastKey < kJustNow;
}
