// Light, sky and ground.
import * as THREE from "three";
import { skyTexture, type Theme } from "./theme";

const kGridReach = 60; // grid lines on each side of the target

// A grid with two spacings, one ten times the other, that fades with the distance from its centre.
const kGridVertex = `
    varying vec2 place;
    void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        place = world.xy;
        vec4 mvPosition = viewMatrix * world;
        gl_Position = projectionMatrix * mvPosition;
    }`;
const kGridFragment = `
    varying vec2 place;
    uniform float spacing;
    uniform float reach;
    uniform vec2 middle;
    uniform vec3 color;
    uniform vec3 colorX;
    uniform vec3 colorY;
    float lines(float size, vec2 pixel) {
        vec2 at = place / size;
        vec2 near = abs(fract(at - 0.5) - 0.5) * size / pixel;
        return 1.0 - min(min(near.x, near.y), 1.0);
    }
    void main() {
        vec2 pixel = max(fwidth(place), 1e-6);
        float fade = 1.0 - smoothstep(0.25, 1.0, length(place - middle) / reach);
        if (fade <= 0.0) discard;
        float fine = lines(spacing, pixel) * (1.0 - smoothstep(0.15, 0.5, (pixel.x + pixel.y) / spacing));
        float strength = max(fine * 0.28, lines(spacing * 10.0, pixel) * 0.6);
        vec2 axis = 1.0 - min(abs(place) / (pixel * 1.3), 1.0);
        vec3 shade = mix(color, colorX, axis.y);
        shade = mix(shade, colorY, axis.x * (1.0 - axis.y));
        strength = max(strength, max(axis.x, axis.y) * 0.9);
        if (strength * fade < 0.004) discard;
        gl_FragColor = vec4(shade, strength * fade);
        #include <colorspace_fragment>
    }`;

/** [degree] height and azimuth of the sun, clockwise from north (+Y), at an hour of a long day. */
export function sunAt(hour: number, north: number): { height: number; azimuth: number } {
    const day = Math.min(Math.max((hour - 5) / 14, 0), 1);
    return { height: 3 + 57 * Math.sin(Math.PI * day), azimuth: (70 + 220 * day + north + 360) % 360 };
}

function sunDirection(hour: number, north: number): THREE.Vector3 {
    const { height, azimuth } = sunAt(hour, north);
    const [h, a] = [THREE.MathUtils.degToRad(height), THREE.MathUtils.degToRad(azimuth)];
    return new THREE.Vector3(Math.sin(a) * Math.cos(h), Math.cos(a) * Math.cos(h), Math.sin(h));
}

/** The spacing of a grid, a power of ten in metres, for a camera at this distance. */
export function gridStep(distance: number): number {
    return 10 ** Math.floor(Math.log10(Math.max(distance, 1e-4) / 5));
}

export class Stage {
    readonly group = new THREE.Group();
    private readonly sun = new THREE.DirectionalLight("#fff4e2", 2.5);
    private readonly fill = new THREE.DirectionalLight("#cfe0ff", 0.55);
    private readonly sky = new THREE.HemisphereLight("#e8f1ff", "#8d857a", 1.5);
    private readonly floor = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.ShadowMaterial({ depthWrite: false }));
    private readonly grid: THREE.Mesh<THREE.PlaneGeometry, THREE.ShaderMaterial>;
    private background: THREE.Texture | null = null;

    constructor(private readonly scene: THREE.Scene) {
        const material = new THREE.ShaderMaterial({
            vertexShader: kGridVertex,
            fragmentShader: kGridFragment,
            transparent: true,
            depthWrite: false,
            side: THREE.DoubleSide,
            uniforms: {
                spacing: { value: 1 },
                reach: { value: 1 },
                middle: { value: new THREE.Vector2() },
                color: { value: new THREE.Color() },
                colorX: { value: new THREE.Color() },
                colorY: { value: new THREE.Color() },
            },
        });
        this.grid = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material);
        this.sky.position.set(0, 0, 1); // Z is up
        this.sun.castShadow = true;
        this.sun.shadow.mapSize.set(2048, 2048);
        this.sun.shadow.radius = 1.2; // a larger value makes the noise visible
        this.floor.receiveShadow = true;
        this.floor.renderOrder = -2;
        this.grid.renderOrder = -1;
        this.group.add(this.sun, this.sun.target, this.fill, this.fill.target, this.sky, this.floor, this.grid);
        scene.add(this.group);
    }

    setTheme(theme: Theme): void {
        this.background?.dispose();
        this.background = skyTexture(theme.sky);
        this.scene.background = this.background;
        const { uniforms } = this.grid.material;
        uniforms.color.value.set(theme.line);
        uniforms.colorX.value.set(theme.axisX);
        uniforms.colorY.value.set(theme.axisY);
        this.floor.material.opacity = theme.shadow;
    }

    /** Sets the sun to an hour; its shadows cover the sphere, which touches the ground at `bottom`. */
    light(hour: number, north: number, shadow: boolean, around: THREE.Sphere): void {
        const direction = sunDirection(hour, north);
        const radius = Math.max(around.radius, 0.01);
        this.sun.castShadow = shadow;
        this.floor.visible = shadow;
        this.sun.target.position.copy(around.center);
        this.sun.position.copy(around.center).addScaledVector(direction, radius * 3);
        this.fill.target.position.copy(around.center);
        this.fill.position.copy(around.center).add(new THREE.Vector3(-direction.x, -direction.y, 0.4).multiplyScalar(radius));
        const camera = this.sun.shadow.camera;
        camera.left = camera.bottom = -radius * 1.15;
        camera.right = camera.top = radius * 1.15;
        camera.near = radius * 0.5;
        camera.far = radius * 12; // a low sun makes long shadows
        camera.updateProjectionMatrix();
        this.sun.shadow.normalBias = (radius / 2048) * 3;
        this.sun.shadow.bias = -0.0004;
        // The floor is not larger than the shadow of the sphere, because shadow tests are slow without a GPU.
        const { x, y, z } = direction;
        const rise = around.center.z / z;
        this.floor.position.set(around.center.x - x * rise, around.center.y - y * rise, 0);
        this.floor.rotation.z = Math.atan2(y, x);
        this.floor.scale.set((2.1 * radius) / z, 2.1 * radius, 1);
    }

    /** Places the grid below the target. */
    ground(distance: number, middle: THREE.Vector3, isShown: boolean): void {
        const step = gridStep(distance);
        const reach = Math.max(step * kGridReach, distance * 4);
        const { uniforms } = this.grid.material;
        uniforms.spacing.value = step;
        uniforms.reach.value = reach;
        uniforms.middle.value.set(middle.x, middle.y);
        this.grid.visible = isShown;
        this.grid.position.set(middle.x, middle.y, 0);
        this.grid.scale.setScalar(2 * reach);
    }
}
