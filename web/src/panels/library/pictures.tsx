// Small images of skeletons, made when they become visible and cached.
import type { VNode } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Geometry } from "../../app";
import { type Silhouette, silhouetteOf } from "./silhouette";

const kSize = 96; // [px]
const kMaxKept = 4000;
const kAtOnce = 4;

export type Load = () => Promise<Geometry>;

interface PictureRequest {
    key: string;
    load: Load;
    resolve(picture: Silhouette): void;
    reject(error: Error): void;
}

/** Images by key. The newest request is served first, because it is visible. */
class Pictures {
    private readonly kept = new Map<string, Promise<Silhouette>>();
    private readonly queue: PictureRequest[] = [];
    private running = 0;

    get(key: string, load: Load): Promise<Silhouette> {
        const known = this.kept.get(key);
        if (known) {
            return known;
        }
        const picture = new Promise<Silhouette>((resolve, reject) => this.queue.push({ key, load, resolve, reject }));
        picture.catch(() => this.kept.delete(key)); // a later attempt may succeed
        this.kept.set(key, picture);
        if (this.kept.size > kMaxKept) {
            this.kept.delete(this.kept.keys().next().value ?? "");
        }
        this.next();
        return picture;
    }

    /** Cancels a request. */
    drop(key: string): void {
        const at = this.queue.findIndex((request) => request.key === key);
        if (at >= 0) {
            this.queue.splice(at, 1);
            this.kept.delete(key);
        }
    }

    private next(): void {
        const request = this.running < kAtOnce ? this.queue.pop() : undefined;
        if (request) {
            ++this.running;
            request
                .load()
                .then((geometry) => request.resolve(silhouetteOf(geometry, kSize)), request.reject)
                .finally(() => {
                    --this.running;
                    this.next();
                });
        }
    }
}

const pictures = new Pictures();

export function Strokes({ picture }: { picture: Silhouette }): VNode {
    return (
        <svg class="silhouette" viewBox={`0 0 ${picture.size} ${picture.size}`} aria-hidden="true">
            {picture.strokes.map(({ width, path }) => (
                <path key={width} d={path} stroke-width={width} />
            ))}
        </svg>
    );
}

/** An image that is requested when it becomes visible. */
export function Picture({ id, load }: { id: string; load: Load }): VNode {
    const place = useRef<HTMLDivElement>(null);
    const [picture, setPicture] = useState<Silhouette | null>(null);
    const [errorText, setErrorText] = useState("");
    useEffect(() => {
        let wanted = true;
        setErrorText("");
        const watch = new IntersectionObserver((entries) => {
            if (entries.some((entry) => entry.isIntersecting)) {
                watch.disconnect();
                pictures.get(id, load).then(
                    (drawn) => wanted && setPicture(drawn),
                    (error: Error) => wanted && setErrorText(error.message),
                );
            }
        });
        if (place.current) {
            watch.observe(place.current);
        }
        return () => {
            wanted = false;
            watch.disconnect();
            pictures.drop(id);
        };
    }, [id]);
    return (
        <div class="picture-box" ref={place} title={errorText || undefined}>
            {errorText ? (
                <span class="error">no image</span>
            ) : picture ? (
                <Strokes picture={picture} />
            ) : (
                <span class="hint" aria-hidden="true">
                    …
                </span>
            )}
        </div>
    );
}
