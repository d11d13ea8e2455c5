// The figures of a check in groups: label, unit and explanation of each.

export type Figure = number | boolean | { [name: string]: Figure };
export type Figures = Record<string, Figure>;

interface Described {
    name: string; // "volume.ratio": of a group, the key inside it
    label: string;
    unit?: string; // "m3"; "radii"
    says: string;
    isBad?(value: number | boolean): boolean; // whether the user should inspect the value
}

const more = (most: number) => (value: number | boolean) => Number(value) > most;
const less = (least: number) => (value: number | boolean) => Number(value) < least;

const kGroups: readonly { title: string; figures: readonly Described[] }[] = [
    {
        title: "Topology",
        figures: [
            { name: "sound", label: "Sound", says: "Watertight, and no faces cross.", isBad: (value) => value === false },
            { name: "watertight", label: "Watertight", says: "Closed and oriented, without bad edges: it has an inside.", isBad: (value) => value === false },
            { name: "vertices", label: "Vertices", says: "" },
            { name: "faces", label: "Faces", says: "" },
            { name: "quads_percent", label: "Quads", unit: "%", says: "Faces with four corners." },
            { name: "components", label: "Pieces", says: "Connected components: one for each tree; additional ones are loose components or cavities." },
            { name: "euler", label: "Euler number", says: "2 for each component like a ball, minus 2 for each handle." },
            { name: "open_edges", label: "Open edges", says: "Edges of one face: the border of a hole.", isBad: more(0) },
            { name: "non_manifold_edges", label: "Non-manifold edges", says: "Edges of more than two faces.", isBad: more(0) },
            { name: "non_manifold_vertices", label: "Non-manifold vertices", says: "Corners at which separate fans of faces meet.", isBad: more(0) },
            { name: "misoriented_edges", label: "Misoriented edges", says: "Edges between faces with different orientation.", isBad: more(0) },
            { name: "irregular_percent", label: "Irregular vertices", unit: "%", says: "Vertices without exactly four faces. Forks require some." },
        ],
    },
    {
        title: "Crossings",
        figures: [
            { name: "intersections.total", label: "Pairs of faces", says: "Total number of crossing pairs.", isBad: more(0) },
            { name: "intersections.local", label: "Of neighbours", says: "Adjacent along the skeleton." },
            { name: "intersections.overlap", label: "In the skeleton itself", says: "Branches that overlap in the skeleton." },
            { name: "intersections.remote", label: "Of others", says: "Branches that overlap only by their surfaces." },
            { name: "crossing_places.total", label: "Places", says: "Pairs with common vertices where the faces join smoothly.", isBad: more(0) },
        ],
    },
    {
        title: "Shape of faces",
        figures: [
            {
                name: "scaled_jacobian.p1",
                label: "Squareness, worst percentile",
                says: "1 for a rectangle, 0 if a corner is flat; above 0.4 is good.",
                isBad: less(0.2),
            },
            { name: "scaled_jacobian.mean", label: "Squareness, mean", says: "" },
            { name: "scaled_jacobian.min", label: "Squareness, minimum", says: "" },
            { name: "inverted_faces", label: "Inverted faces", says: "With a corner that is flat or concave.", isBad: more(0) },
            { name: "face_angle_degrees.mean", label: "Angle between faces, mean", unit: "°", says: "0 is flat." },
            { name: "face_angle_degrees.max", label: "Angle between faces, maximum", unit: "°", says: "" },
            { name: "bending", label: "Bending", says: "Total deviation from a flat surface: 25 for a ball." },
            { name: "fork_bending", label: "Bending at forks", says: "Of the faces within two radii of the forks." },
            { name: "fork_face_angle_degrees.mean", label: "Angle at forks, mean", unit: "°", says: "" },
        ],
    },
    {
        title: "Size",
        figures: [
            { name: "signed_volume", label: "Volume", unit: "m³", says: "Enclosed volume; negative if the faces are inverted.", isBad: less(0) },
            { name: "area", label: "Area", unit: "m²", says: "Of all faces." },
            { name: "volume.cones", label: "Volume of the skeleton", unit: "m³", says: "Of its rounded cones; overlaps are counted once." },
            { name: "volume.ratio", label: "Volume ratio", says: "Volume of the surface divided by the volume of the skeleton." },
            { name: "volume.missing_percent", label: "Missing", unit: "%", says: "Volume of the skeleton outside the surface.", isBad: more(1) },
        ],
    },
    {
        title: "Comparison with the skeleton",
        figures: [
            {
                name: "radius_regular.mean",
                label: "Radius of branches, mean",
                unit: "radii",
                says: "Relative distance of vertices from the axis on unforked branches: 0.02 is 2 % too large.",
            },
            { name: "radius_regular.mean_abs", label: "Radius of branches, error", unit: "radii", says: "The mean of the absolute values." },
            { name: "radius_all.mean_abs", label: "Radius everywhere, error", unit: "radii", says: "The same including forks, roots and tips." },
            { name: "radius_all.max", label: "Maximum distance outside", unit: "radii", says: "" },
            { name: "segments_missing", label: "Segments missing", says: "Segments outside the surface.", isBad: more(0) },
            { name: "axes.severed", label: "Severed positions", says: "Positions where an axis leaves the surface, or is too close to it.", isBad: more(0) },
            { name: "axes.thin_percent", label: "Thin", unit: "%", says: "Of the axes, closer to the surface than 0.4 radii." },
            { name: "trees", label: "Trees", says: "" },
            { name: "parts", label: "Components of the surface", says: "" },
            { name: "parts_loose", label: "Loose components", says: "Detached branches, cavities, bubbles.", isBad: more(0) },
            { name: "tips", label: "Tips", says: "" },
            { name: "tips_short", label: "Short tips", says: "Where the surface ends more than 0.1 radii before the tip.", isBad: more(0) },
            {
                name: "tip_reach.p1",
                label: "Reach of tips, minimum",
                unit: "radii",
                says: "Beyond the last node: 1 for a round tip, 0 for a flat one; 1 % are shorter.",
            },
        ],
    },
];

export interface FigureRow {
    label: string;
    value: number | boolean;
    unit: string;
    says: string;
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
            rows: described.flatMap(({ name, label, unit = "", says, isBad }) => {
                const value = find(figures, name);
                return value === undefined ? [] : [{ label, value, unit, says, isBad: isBad?.(value) ?? false }];
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
