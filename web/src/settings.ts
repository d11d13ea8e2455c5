// User settings of the page, stored by the browser.
import { effect, type Signal, signal } from "@preact/signals-core";

function read(key: string): unknown {
    try {
        return JSON.parse(localStorage.getItem(key) ?? "null");
    } catch {
        return null; // storage may be disabled, or contain a value of another program
    }
}

/** A persistent signal. A stored value is used if it has the type of the first value. */
export function setting(name: string, first: number): Signal<number>;
export function setting(name: string, first: boolean): Signal<boolean>;
export function setting<T extends string>(name: string, first: T, allowed?: readonly T[]): Signal<T>;
export function setting<T>(name: string, first: T, allowed?: readonly T[]): Signal<T> {
    const key = `coppice.${name}`;
    const kept = read(key);
    const fits = typeof kept === typeof first && (!allowed || allowed.includes(kept as T));
    const value = signal<T>(fits ? (kept as T) : first);
    let begun = false;
    effect(() => {
        const now = value.value;
        if (begun) {
            try {
                localStorage.setItem(key, JSON.stringify(now));
            } catch {
                // then it is kept as long as the page is open
            }
        }
        begun = true;
    });
    return value;
}
