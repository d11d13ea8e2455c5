// The figures of a check in groups: label, unit and explanation of each.

export type Figure = number | boolean | { [name: string]: Figure };
export type Figures = Record<string, Figure>;

interface Described {
    name: string; // "volume.ratio": of a group, the key inside it
    label: string;
    unit?: string; // "m3"; "radii"
    description: string;
    isBad?(value: number | boolean): boolean; // whether the user should inspect the value
}

const more = (most: number) => (value: number | boolean) => Number(value) > most;
const less = (least: number) => (value: number | boolean) => Number(value) < least;

const kGroups: readonly { title: string; figures: readonly Described[] }[] = [
    {
        title: "Topology",
        figures: [
            { name: "sound", label: "Sound", description: "Watertight, and no faces cross.", isBad: (value) => value === false },
            {
                name: "watertight",
                label: "Watertight",
                description: "Closed and oriented, without bad edges: it has an inside.",
                isBad: (value) => value === false,
            },
            { name: "vertices", label: "Vertices", description: "" },
            { name: "faces", label: "Faces", description: "" },
            { name: "quads_percent", label: "Quads", unit: "%", description: "Faces with four corners." },
            { name: "components", label: "Pieces", description: "Connected components: one for each tree; additional ones are loose components or cavities." },
            { name: "euler", label: "Euler number", description: "2 for each component like a ball, minus 2 for each handle." },
            { name: "open_edges", label: "Open edges", description: "Edges of one face: the border of a hole.", isBad: more(0) },
            { name: "non_manifold_edges", label: "Non-manifold edges", description: "Edges of more than two faces.", isBad: more(0) },
            { name: "non_manifold_vertices", label: "Non-manifold vertices", description: "Corners at which separate fans of faces meet.", isBad: more(0) },
            { name: "misoriented_edges", label: "Misoriented edges", description: "Edges between faces with different orientation.", isBad: more(0) },
            { name: "irregular_percent", label: "Irregular vertices", unit: "%", description: "Vertices without exactly four faces. Forks require some." },
        ],
    },
    {
        title: "Crossings",
        figures: [
            { name: "intersections.total", label: "Pairs of faces", description: "Total number of crossing pairs.", isBad: more(0) },
            { name: "intersections.local", label: "Of neighbours", description: "Adjacent along the skeleton." },
            { name: "intersections.overlap", label: "In the skeleton itself", description: "Branches that overlap in the skeleton." },
            { name: "intersections.remote", label: "Of others", description: "Branches that overlap only by their surfaces." },
            { name: "crossing_places.total", label: "Places", description: "Pairs with common vertices where the faces join smoothly.", isBad: more(0) },
        ],
    },
    {
        title: "Shape of faces",
        figures: [
            {
                name: "scaled_jacobian.p1",
                label: "Squareness, worst percentile",
                description: "1 for a rectangle, 0 if a corner is flat; above 0.4 is good.",
                isBad: less(0.2),
            },
            { name: "scaled_jacobian.mean", label: "Squareness, mean", description: "" },
            { name: "scaled_jacobian.min", label: "Squareness, minimum", description: "" },
            { name: "inverted_faces", label: "Inverted faces", description: "With a corner that is flat or concave.", isBad: more(0) },
            { name: "face_angle_degrees.mean", label: "Angle between faces, mean", unit: "°", description: "0 is flat." },
            { name: "face_angle_degrees.max", label: "Angle between faces, maximum", unit: "°", description: "" },
            { name: "bending", label: "Bending", description: "Total deviation from a flat surface: 25 for a ball." },
            { name: "fork_bending", label: "Bending at forks", description: "Of the faces within two radii of the forks." },
            { name: "fork_face_angle_degrees.mean", label: "Angle at forks, mean", unit: "°", description: "" },
        ],
    },
    {
        title: "Size",
        figures: [
            { name: "signed_volume", label: "Volume", unit: "m³", description: "Enclosed volume; negative if the faces are inverted.", isBad: less(0) },
            { name: "area", label: "Area", unit: "m²", description: "Of all faces." },
            { name: "volume.cones", label: "Volume of the skeleton", unit: "m³", description: "Of its rounded cones; overlaps are counted once." },
            { name: "volume.ratio", label: "Volume ratio", description: "Volume of the surface divided by the volume of the skeleton." },
            { name: "volume.missing_percent", label: "Missing", unit: "%", description: "Volume of the skeleton outside the surface.", isBad: more(1) },
        ],
    },
    {
        title: "Comparison with the skeleton",
        figures: [
            {
                name: "radius_regular.mean",
                label: "Radius of branches, mean",
                unit: "radii",
                description: "Relative distance of vertices from the axis on unforked branches: 0.02 is 2 % too large.",
            },
            { name: "radius_regular.mean_abs", label: "Radius of branches, error", unit: "radii", description: "The mean of the absolute values." },
            { name: "radius_all.mean_abs", label: "Radius everywhere, error", unit: "radii", description: "The same including forks, roots and tips." },
            { name: "radius_all.max", label: "Maximum distance outside", unit: "radii", description: "" },
            { name: "segments_missing", label: "Segments missing", description: "Segments outside the surface.", isBad: more(0) },
            {
                name: "axes.severed",
                label: "Severed positions",
                description: "Positions where an axis leaves the surface, or is too close to it.",
                isBad: more(0),
            },
            { name: "axes.thin_percent", label: "Thin", unit: "%", description: "Of the axes, closer to the surface than 0.4 radii." },
            { name: "trees", label: "Trees", description: "" },
            { name: "parts", label: "Components of the surface", description: "" },
            { name: "parts_loose", label: "Loose components", description: "Detached branches, cavities, bubbles.", isBad: more(0) },
            { name: "tips", label: "Tips", description: "" },
            { name: "tips_short", label: "Short tips", description: "Where the surface ends more than 0.1 radii before the tip.", isBad: more(0) },
            {
                name: "tip_reach.p1",
                label: "Reach of tips, minimum",
                unit: "radii",
                description: "Beyond the last node: 1 for a round tip, 0 for a flat one; 1 % are shorter.",
            },
        ],
    },
];

export interface FigureRow {
    label: string;
    value: number | boolean;
    unit: string;
    description: string;
    isBad: boolean;
}

export interface FigureGroup {
    title: string;
    rows: FigureRow[];
}

function find(figures: Figures, name: string): number | boolean | undefined {
    const found = name.split(".").reduce<Figure | undefined>((at, part) => (typeof at === "object" ? at[part] : undefined), figures);
    return typeof found === "object" ? undefined : found;
}

/** The available figures of the check, in groups; empty groups are omitted. */
export function grouped(figures: Figures): FigureGroup[] {
    return kGroups
        .map(({ title, figures: described }) => ({
            title,
            rows: described.flatMap(({ name, label, unit = "", description, isBad }) => {
                const value = find(figures, name);
                return value === undefined ? [] : [{ label, value, unit, description, isBad: isBad?.(value) ?? false }];
            }),
        }))
        .filter(({ rows }) => rows.length > 0);
}

export interface CrossingPlace {
    at: [number, number, number];
    radius: number; // [m]; 0: unknown
    pairs: number; // of faces; 0: unknown
}

/** The positions of crossings, those with most pairs first; the figures contain more details than the plain list. */
export function crossingPlaces(figures: Figures, crossings: readonly [number, number, number][]): CrossingPlace[] {
    return crossings.map((at, k) => {
        const figure = (part: string) => Number(find(figures, `crossing_place_${k + 1}.${part}`) ?? 0);
        return { at, radius: figure("radius"), pairs: figure("pairs") };
    });
}
