// Materials of meshes: their images as textures, shared by all meshes that show them.
import * as THREE from "three";
import type { Engine } from "../app";
import type { ImageKeys } from "../protocol";
import { kRoughness } from "./tubes";

const kProperties = { color: "map", normal: "normalMap", roughness: "roughnessMap", occlusion: "aoMap" } as const;
const kAnisotropy = 4; // maximum number of samples of a texture where it is seen at a grazing angle

type ImageName = keyof ImageKeys;

/** The images of a material, by the properties of the shader. */
export type Maps = Partial<Record<(typeof kProperties)[ImageName], THREE.Texture>>;

/** The images of a mesh by slot, until they are released. */
export interface HeldMaps {
    maps: Maps[];
    release(): void;
}

/** Sets the images of a shader, and removes those that it no longer has. */
export function setMaps(material: THREE.MeshStandardMaterial, maps: Maps): void {
    for (const name of Object.values(kProperties)) {
        const texture = maps[name] ?? null;
        if (material[name] !== texture) {
            material[name] = texture;
            material.needsUpdate = true;
        }
    }
    material.roughness = maps.roughnessMap ? 1 : kRoughness;
    // The tone mapping of the view subtracts a reflection of the surroundings, which dark bark does not have here.
    material.toneMapped = !maps.map;
}

// v increases from the last row to the first. WebGL does not flip bitmaps, so that the browser flips them when it decodes them.
async function decoded(image: Blob, isColor: boolean): Promise<THREE.Texture> {
    const bitmap = await createImageBitmap(image, { imageOrientation: "flipY", colorSpaceConversion: "none", premultiplyAlpha: "none" });
    const texture = new THREE.Texture(bitmap);
    texture.flipY = false;
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.anisotropy = kAnisotropy;
    texture.colorSpace = isColor ? THREE.SRGBColorSpace : THREE.NoColorSpace;
    texture.needsUpdate = true;
    return texture;
}

function dispose(texture: THREE.Texture): void {
    texture.dispose();
    (texture.image as ImageBitmap).close();
}

export class Materials {
    private readonly textures = new Map<string, { texture: Promise<THREE.Texture>; users: number }>();
    private taking = 0;

    constructor(private readonly engine: Engine) {}

    /** The images of the materials of a mesh. Those that are already in use are not requested again. */
    async take(mesh: string): Promise<HeldMaps> {
        ++this.taking;
        try {
            const { images } = await this.engine.request<{ images: ImageKeys[] }>("material", { name: mesh });
            return await this.takeImages(images);
        } finally {
            --this.taking;
        }
    }

    /** The same for known keys, by slot. */
    async takeImages(images: ImageKeys[]): Promise<HeldMaps> {
        ++this.taking;
        try {
            const slots = images.map((keys) => Object.entries(keys) as [ImageName, string][]);
            const release = () => slots.flat().forEach(([, key]) => this.release(key));
            const coming = slots.map(async (keys) => {
                const maps = keys.map(async ([name, key]) => [kProperties[name], await this.hold(key, name === "color")] as const);
                return Object.fromEntries(await Promise.all(maps)) as Maps;
            });
            try {
                return { maps: await Promise.all(coming), release };
            } catch (error) {
                release();
                throw error;
            }
        } finally {
            --this.taking;
        }
    }

    get busy(): boolean {
        return this.taking > 0;
    }

    private hold(key: string, isColor: boolean): Promise<THREE.Texture> {
        const entry = this.textures.get(key) ?? { texture: this.engine.image(key).then((image) => decoded(image, isColor)), users: 0 };
        this.textures.set(key, entry);
        ++entry.users;
        return entry.texture;
    }

    private release(key: string): void {
        const entry = this.textures.get(key);
        if (entry && --entry.users === 0) {
            this.textures.delete(key);
            entry.texture.then(dispose, () => undefined); // a failure was reported to those who took it
        }
    }
}
