// Signals in components.
import { effect, type ReadonlySignal } from "@preact/signals-core";
import type { ComponentChildren, VNode } from "preact";
import { useEffect, useLayoutEffect, useReducer, useRef } from "preact/hooks";

function useRefresh(): () => void {
    const [, refresh] = useReducer((n: number) => n + 1, 0);
    return refresh as () => void;
}

/** The value of a signal; the component is redrawn when it changes. */
export function useValue<T>(signal: ReadonlySignal<T>): T {
    const refresh = useRefresh();
    const shown = useRef<T | undefined>(undefined);
    const value = signal.peek();
    shown.current = value;
    useLayoutEffect(
        () =>
            signal.subscribe((now) => {
                if (now !== shown.current) {
                    refresh();
                }
            }),
        [signal],
    );
    return value;
}

/** Redraws when a signal changes that `draw` reads. */
export function Tracked({ draw }: { draw: () => ComponentChildren }): VNode {
    const refresh = useRefresh();
    const stop = useRef<(() => void) | undefined>(undefined);
    stop.current?.();
    let drawn: ComponentChildren = null;
    let first = true;
    stop.current = effect(() => {
        if (first) {
            drawn = draw();
        } else {
            refresh();
        }
        first = false;
    });
    useEffect(() => () => stop.current?.(), []);
    return <>{drawn}</>;
}

/** A component that is redrawn when a signal changes that it reads. */
export function tracked<P>(draw: (props: P) => ComponentChildren): (props: P) => VNode {
    return (props) => <Tracked draw={() => draw(props)} />;
}
