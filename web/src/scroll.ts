/** Scrolls a box as far as it takes to show what lies in it from `top` to `bottom` [px]. What the box itself lies in stays where it is. */
export function scrollWithin(box: HTMLElement, top: number, bottom: number): void {
    box.scrollTop = Math.min(Math.max(box.scrollTop, bottom - box.clientHeight), top);
}
