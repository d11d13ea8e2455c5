/**
 * Scrolls a box by the minimum distance that makes its range from `top` to `bottom` [px] visible. Containers of the box do not
 * scroll.
 */
export function scrollWithin(box: HTMLElement, top: number, bottom: number): void {
    box.scrollTop = Math.min(Math.max(box.scrollTop, bottom - box.clientHeight), top);
}
