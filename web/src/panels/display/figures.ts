// The figures of a check in groups that people can read: what each is called, its unit, and what it says.

export type Figure = number | boolean | { [name: string]: Figure };
export type Figures = Record<string, Figure>;

interface Described {
    name: string; // "volume.ratio": of a group, its part
    label: string;
    unit?: string; // "m3"; "radii"
    says: string;
    isBad?(value: number | boolean): boolean; // what a person should look at
}

const more = (most: number) => (value: number | boolean) => Number(value) > most;
const less = (least: number) => (value: number | boolean) => Number(value) < least;

const kGroups: readonly { title: string; figures: readonly Described[] }[] = [
    {
        title: "How faces join",
        figures: [
            { name: "sound", label: "Sound", says: "Watertight, and no faces cross.", isBad: (value) => value === false },
            { name: "watertight", label: "Watertight", says: "Closed, without bad edges, and of one side: it has an inside.", isBad: (value) => value === false },
            { name: "vertices", label: "Vertices", says: "" },
            { name: "faces", label: "Faces", says: "" },
            { name: "quads_percent", label: "Quads", unit: "%", says: "Faces with four corners." },
            { name: "components", label: "Pieces", says: "Parts that no edge joins: one for each tree, more where something is loose or hollow." },
            { name: "euler", label: "Euler number", says: "2 for each part that is like a ball, 2 less for each hole that one can look through." },
            { name: "open_edges", label: "Open edges", says: "Edges of one face: the rim of a hole.", isBad: more(0) },
            { name: "non_manifold_edges", label: "Non-manifold edges", says: "Edges of more than two faces.", isBad: more(0) },
            { name: "non_manifold_vertices", label: "Non-manifold vertices", says: "Corners at which separate fans of faces meet.", isBad: more(0) },
            { name: "misoriented_edges", label: "Misoriented edges", says: "Edges whose faces do not agree which side is out.", isBad: more(0) },
            { name: "irregular_percent", label: "Irregular vertices", unit: "%", says: "Without exactly four faces. Forks need some." },
        ],
    },
    {
        title: "Crossings",
        figures: [
            { name: "intersections.total", label: "Pairs of faces", says: "That cross each other, in all.", isBad: more(0) },
            { name: "intersections.local", label: "Of neighbours", says: "Along the skeleton." },
            { name: "intersections.overlap", label: "In the skeleton itself", says: "Of branches that overlap there already." },
            { name: "intersections.remote", label: "Of others", says: "Branches that only their surfaces bring together." },
            { name: "crossing_places.total", label: "Places", says: "Pairs whose faces share corners are at one.", isBad: more(0) },
        ],
    },
    {
        title: "Shape of faces",
        figures: [
            { name: "scaled_jacobian.p1", label: "Squareness, worst hundredth", says: "1 for a rectangle, 0 where a corner is flat; above 0.4 is good.", isBad: less(0.2) },
            { name: "scaled_jacobian.mean", label: "Squareness, mean", says: "" },
            { name: "scaled_jacobian.min", label: "Squareness, least", says: "" },
            { name: "inverted_faces", label: "Faces turned over", says: "With a corner that is flat or bent in.", isBad: more(0) },
            { name: "face_angle_degrees.mean", label: "Angle between faces, mean", unit: "°", says: "0 is flat." },
            { name: "face_angle_degrees.max", label: "Angle between faces, greatest", unit: "°", says: "" },
            { name: "bending", label: "Bending", says: "How far from flat it is in all: 25 for a ball." },
            { name: "fork_bending", label: "Bending at forks", says: "Of the faces within two radii of them." },
            { name: "fork_face_angle_degrees.mean", label: "Angle at forks, mean", unit: "°", says: "" },
        ],
    },
    {
        title: "Size",
        figures: [
            { name: "signed_volume", label: "Volume", unit: "m³", says: "Enclosed; below 0 when faces look inward.", isBad: less(0) },
            { name: "area", label: "Area", unit: "m²", says: "Of all faces." },
            { name: "volume.cones", label: "Volume of the skeleton", unit: "m³", says: "Of its rounded cones, what overlaps counting once." },
            { name: "volume.ratio", label: "Share of that", says: "Volume of the surface over that of the skeleton." },
            { name: "volume.missing_percent", label: "Missing", unit: "%", says: "Of the skeleton's volume that lies outside of the surface.", isBad: more(1) },
        ],
    },
    {
        title: "Against the skeleton",
        figures: [
            { name: "radius_regular.mean", label: "Radius of branches, mean", unit: "radii", says: "How far out vertices lie where nothing but one branch is: 0.02 is 2 % too far." },
            { name: "radius_regular.mean_abs", label: "Radius of branches, error", unit: "radii", says: "The mean without signs." },
            { name: "radius_all.mean_abs", label: "Radius everywhere, error", unit: "radii", says: "The same with forks, roots and tips." },
            { name: "radius_all.max", label: "Farthest out", unit: "radii", says: "" },
            { name: "segments_missing", label: "Segments missing", says: "Segments that lie outside of the surface.", isBad: more(0) },
            { name: "axes.severed", label: "Severed places", says: "Where an axis leaves the surface, or comes too near to it.", isBad: more(0) },
            { name: "axes.thin_percent", label: "Thin", unit: "%", says: "Of the axes, nearer to the surface than 0.4 radii." },
            { name: "trees", label: "Trees", says: "" },
            { name: "parts", label: "Parts of the surface", says: "" },
            { name: "parts_loose", label: "Loose parts", says: "Branches that were torn off, hollows, bubbles.", isBad: more(0) },
            { name: "tips", label: "Tips", says: "" },
            { name: "tips_short", label: "Short tips", says: "That the surface ends before by over 0.1 radii.", isBad: more(0) },
            { name: "tip_reach.p1", label: "Reach of tips, shortest", unit: "radii", says: "Beyond the last node: 1 for a round tip, 0 for a flat one; 1 % are shorter." },
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

/** The figures that the check has, in groups; groups without any are left out. */
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
    radius: number; // [m]; 0: not known
    pairs: number; // of faces; 0: not known
}

/** The places of crossings, those with most pairs first; figures tell more of them than the bare list does. */
export function crossingPlaces(figures: Figures, crossings: readonly [number, number, number][]): CrossingPlace[] {
    return crossings.map((at, k) => {
        const told = (part: string) => Number(find(figures, `crossing_place_${k + 1}.${part}`) ?? 0);
        return { at, radius: told("radius"), pairs: told("pairs") };
    });
}
