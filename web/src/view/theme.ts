// Colours of the view for the colour scheme of the system.
import * as THREE from "three";

export interface Theme {
    sky: [string, string]; // above and below
    line: string;
    axisX: string;
    axisY: string;
    solid: string;
    bark: string;
    mesh: string;
    mark: string;
    control: string;
    bones: string;
    wire: string;
    hover: string;
    selected: string;
    cut: string;
    shadow: number; // opacity
}

export const kDark: Theme = {
    sky: ["#41484d", "#24282b"],
    line: "#8b9594",
    axisX: "#c9604f",
    axisY: "#6fa858",
    solid: "#86b877",
    bark: "#b39a7d",
    mesh: "#a9adaf",
    mark: "#9fd0e8",
    control: "#ffb454",
    bones: "#ffe08a",
    wire: "#1b1f21",
    hover: "#fff2b0",
    selected: "#ffa436",
    cut: "#d9774b",
    shadow: 0.42,
};

export const kLight: Theme = {
    sky: ["#f4f6f6", "#ccd3d3"],
    line: "#7c8685",
    axisX: "#b8402f",
    axisY: "#4a8a33",
    solid: "#7fb26f",
    bark: "#a58a6b",
    mesh: "#b4b7b9",
    mark: "#1f6f96",
    control: "#c05a00",
    bones: "#7a1f63",
    wire: "#2b302f",
    hover: "#fff7d0",
    selected: "#f08a1a",
    cut: "#c9622f",
    shadow: 0.3,
};

/** A vertical gradient for the background. */
export function skyTexture([above, below]: [string, string]): THREE.Texture {
    const canvas = document.createElement("canvas");
    canvas.width = 2;
    canvas.height = 256;
    const context = canvas.getContext("2d");
    if (context) {
        const gradient = context.createLinearGradient(0, 0, 0, canvas.height);
        gradient.addColorStop(0, above);
        gradient.addColorStop(1, below);
        context.fillStyle = gradient;
        context.fillRect(0, 0, canvas.width, canvas.height);
    }
    const texture = new THREE.CanvasTexture(canvas);
    texture.colorSpace = THREE.SRGBColorSpace;
    return texture;
}
