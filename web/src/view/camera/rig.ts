// Position and rotation of the camera: a turntable with Z up, around any pivot.
import * as THREE from "three";

export type Side = "front" | "back" | "left" | "right" | "top" | "bottom";

const kQuarter = Math.PI / 2;

/** Yaw and pitch of the standard views; the front looks along +Y. */
export const kSides: Record<Side, [number, number]> = {
    front: [0, 0],
    back: [2 * kQuarter, 0],
    left: [-kQuarter, 0],
    right: [kQuarter, 0],
    top: [0, kQuarter],
    bottom: [0, -kQuarter],
};

export interface Pose {
    eye: THREE.Vector3;
    yaw: number; // [rad] about Z; 0 looks along +Y
    pitch: number; // [rad] in [-pi/2, pi/2]; positive looks down
    distance: number; // [m] to the target: determines the scale of a parallel view
}

const kFieldOfView = 40; // [degree] vertical field of view
const kMinDistance = 1e-4;
const kMaxDistance = 1e6;

export class Rig {
    readonly perspective = new THREE.PerspectiveCamera(kFieldOfView, 1, 0.1, 1000);
    readonly parallel = new THREE.OrthographicCamera();
    isParallel = false;
    pose: Pose = { eye: new THREE.Vector3(6, -12, 6), yaw: 0.45, pitch: 0.25, distance: 14 };
    private width = 1;
    private height = 1;

    get camera(): THREE.PerspectiveCamera | THREE.OrthographicCamera {
        return this.isParallel ? this.parallel : this.perspective;
    }

    right(): THREE.Vector3 {
        return new THREE.Vector3(Math.cos(this.pose.yaw), Math.sin(this.pose.yaw), 0);
    }

    forward(): THREE.Vector3 {
        const { yaw, pitch } = this.pose;
        return new THREE.Vector3(-Math.sin(yaw) * Math.cos(pitch), Math.cos(yaw) * Math.cos(pitch), -Math.sin(pitch));
    }

    up(): THREE.Vector3 {
        return this.right().cross(this.forward());
    }

    target(): THREE.Vector3 {
        return this.forward().multiplyScalar(this.pose.distance).add(this.pose.eye);
    }

    resize(width: number, height: number): void {
        this.width = Math.max(width, 1);
        this.height = Math.max(height, 1);
    }

    /** [m] size of a pixel at a depth along the line of sight. */
    pixelSize(depth: number): number {
        const across = this.isParallel ? this.pose.distance : Math.max(depth, kMinDistance);
        return (2 * across * Math.tan((kFieldOfView * Math.PI) / 360)) / this.height;
    }

    depth(point: THREE.Vector3): number {
        return point.clone().sub(this.pose.eye).dot(this.forward());
    }

    /** Rotates around a pivot, which keeps its position in the view. */
    orbit(yaw: number, pitch: number, pivot: THREE.Vector3): void {
        const before = this.rotation();
        const pose = this.pose;
        pose.yaw = (pose.yaw + yaw) % (4 * kQuarter);
        pose.pitch = Math.min(Math.max(pose.pitch + pitch, -kQuarter), kQuarter);
        const turn = this.rotation().multiply(before.invert());
        pose.eye.sub(pivot).applyQuaternion(turn).add(pivot);
    }

    /** Moves by pixels, so that points at `depth` follow the pointer. */
    pan(dx: number, dy: number, depth: number): void {
        const size = this.pixelSize(depth);
        this.pose.eye.addScaledVector(this.right(), -dx * size).addScaledVector(this.up(), dy * size);
    }

    /** Zooms in for a factor below 1; the point keeps its position in the view. */
    zoom(factor: number, point: THREE.Vector3): void {
        const pose = this.pose;
        const distance = Math.min(Math.max(pose.distance * factor, kMinDistance), kMaxDistance);
        const real = distance / pose.distance;
        pose.eye.sub(point).multiplyScalar(real).add(point);
        pose.distance = distance;
    }

    /** The pose in which a sphere fills the view, from the current or another side. */
    framing(sphere: THREE.Sphere, side?: Side): Pose {
        const [yaw, pitch] = side ? kSides[side] : [this.pose.yaw, this.pose.pitch];
        const half = (kFieldOfView * Math.PI) / 360;
        const narrow = Math.min(half, Math.atan(Math.tan(half) * (this.width / this.height)));
        const distance = Math.max(sphere.radius, 1e-3) / Math.sin(narrow);
        return poseAt(sphere.center, yaw, pitch, distance);
    }

    /** Returns whether a sphere is completely visible. */
    sees({ center, radius }: THREE.Sphere): boolean {
        const offset = center.clone().sub(this.pose.eye);
        const half = this.pixelSize(this.depth(center)) / 2;
        const isWithin = (axis: THREE.Vector3, pixels: number) => Math.abs(offset.dot(axis)) + radius <= half * pixels;
        return this.depth(center) > radius && isWithin(this.right(), this.width) && isWithin(this.up(), this.height);
    }

    /** The pose that looks at the same target from another side. */
    lookingFrom(side: Side): Pose {
        return poseAt(this.target(), ...kSides[side], this.pose.distance);
    }

    /** Sets the cameras to the pose; `seen` is a bounding sphere of all visible objects. */
    apply(seen: THREE.Sphere): void {
        const { eye, distance } = this.pose;
        const depth = this.depth(seen.center);
        const far = Math.max(depth + seen.radius, distance * 2) * 1.05;
        const near = Math.max(depth - seen.radius, Math.min(distance * 0.02, far * 1e-3));
        for (const camera of [this.perspective, this.parallel]) {
            camera.position.copy(eye);
            camera.quaternion.copy(this.rotation());
            camera.near = near;
            camera.far = far;
        }
        const aspect = this.width / this.height;
        this.perspective.aspect = aspect;
        const high = distance * Math.tan((kFieldOfView * Math.PI) / 360);
        this.parallel.top = high;
        this.parallel.bottom = -high;
        this.parallel.left = -high * aspect;
        this.parallel.right = high * aspect;
        this.parallel.near = Math.min(depth - seen.radius, 0) * 1.05 - 1;
        for (const camera of [this.perspective, this.parallel]) {
            camera.updateProjectionMatrix();
            camera.updateMatrixWorld(true);
        }
    }

    private rotation(): THREE.Quaternion {
        const basis = new THREE.Matrix4().makeBasis(this.right(), this.up(), this.forward().negate());
        return new THREE.Quaternion().setFromRotationMatrix(basis);
    }
}

function poseAt(target: THREE.Vector3, yaw: number, pitch: number, distance: number): Pose {
    const forward = new THREE.Vector3(-Math.sin(yaw) * Math.cos(pitch), Math.cos(yaw) * Math.cos(pitch), -Math.sin(pitch));
    return { eye: target.clone().addScaledVector(forward, -distance), yaw, pitch, distance };
}

/** Interpolates two poses, `t` in [0, 1]; rotates in the shorter direction. */
export function between(a: Pose, b: Pose, t: number): Pose {
    const turn = Math.atan2(Math.sin(b.yaw - a.yaw), Math.cos(b.yaw - a.yaw));
    const yaw = a.yaw + turn * t;
    const pitch = a.pitch + (b.pitch - a.pitch) * t;
    const distance = a.distance * (b.distance / a.distance) ** t;
    const centre = (pose: Pose) => poseAt(pose.eye, pose.yaw, pose.pitch, -pose.distance).eye;
    return poseAt(centre(a).lerp(centre(b), t), yaw, pitch, distance);
}
