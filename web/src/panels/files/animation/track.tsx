// The track: seconds, movable keys, and the playhead.
import type { Signal } from "@preact/signals-core";
import type { VNode } from "preact";
import { useRef } from "preact/hooks";
import { useValue } from "../../../use";
import type { Player } from "./player";
import { type Film, freeTime, type Key, keyText, withKey, withoutKey } from "./timeline";

interface TrackProps {
    film: Signal<Film>;
    chosen: Signal<Key | null>;
    player: Player;
}

const kMaxTicks = 12;

/** Multiples of 1, 2 or 5 times a power of ten that fit a length. */
function ticksOf(length: number): number[] {
    const raw = length / kMaxTicks;
    const power = 10 ** Math.floor(Math.log10(Math.max(raw, 1e-3)));
    const step = [1, 2, 5, 10].map((times) => times * power).find((one) => one >= raw) ?? power;
    return Array.from({ length: Math.floor(length / step + 1e-6) + 1 }, (_, n) => n * step);
}

export function Track({ film, chosen, player }: TrackProps): VNode {
    const now = useValue(film);
    const time = useValue(player.time);
    const selected = useValue(chosen);
    const track = useRef<HTMLDivElement>(null);
    const length = Math.max(now.duration, ...now.keys.map((key) => key.time), 1 / now.rate);
    const place = (seconds: number) => ({ left: `${(100 * seconds) / length}%` });

    const put = (key: Key, at: number) => {
        const next = { ...key, time: freeTime(film.peek(), at, key) };
        film.value = withKey(film.peek(), next, key);
        chosen.value = next;
    };
    const drag = (event: PointerEvent, key: Key) => {
        const mark = event.currentTarget as HTMLElement;
        const box = track.current?.getBoundingClientRect();
        if (!box) {
            return;
        }
        chosen.value = key;
        mark.setPointerCapture(event.pointerId);
        mark.onpointermove = (moved) => {
            const mine = chosen.peek();
            if (mine && Math.abs(moved.clientX - event.clientX) > 3) {
                put(mine, Math.min(Math.max((moved.clientX - box.left) / box.width, 0), 1) * length);
            }
        };
        mark.onpointerup = () => {
            mark.onpointermove = null;
        };
    };
    const step = (event: KeyboardEvent, key: Key) => {
        const frames = event.key === "ArrowLeft" ? -1 : event.key === "ArrowRight" ? 1 : 0;
        if (frames !== 0) {
            put(key, key.time + (frames * (event.shiftKey ? 10 : 1)) / now.rate);
            event.preventDefault();
        } else if (event.key === "Delete" || event.key === "Backspace") {
            film.value = withoutKey(now, key);
            chosen.value = null;
            event.preventDefault();
            event.stopPropagation(); // otherwise the selected object would be deleted too
        }
    };
    return (
        <div class="track">
            <div class="track-keys" ref={track} role="group" aria-label="Keys">
                {!now.grow &&
                    now.keys.map((key, at) => (
                        <button
                            key={at}
                            type="button"
                            class="track-key"
                            style={place(key.time)}
                            aria-pressed={key === selected}
                            aria-label={`Key at ${keyText(key)}. Arrow keys move it, Delete removes it.`}
                            title={keyText(key)}
                            onClick={() => {
                                chosen.value = key;
                                player.seek(key.time);
                            }}
                            onPointerDown={(event) => drag(event, key)}
                            onKeyDown={(event) => step(event, key)}
                        />
                    ))}
            </div>
            <input
                type="range"
                class="track-head"
                aria-label="Time in the film"
                aria-valuetext={`${time.toFixed(2)} seconds`}
                min={0}
                max={length}
                step={1 / now.rate}
                value={time}
                onInput={(event) => {
                    player.pause();
                    player.seek(event.currentTarget.valueAsNumber);
                }}
            />
            <div class="track-ticks" aria-hidden="true">
                {ticksOf(length).map((tick) => (
                    <span key={tick} style={place(tick)}>{`${Number(tick.toFixed(3))} s`}</span>
                ))}
            </div>
        </div>
    );
}
