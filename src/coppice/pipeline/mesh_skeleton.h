#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/cage/cage.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/part.h"
#include "coppice/cuda/device.h"
#include "coppice/edit/bend_apart.h"
#include "coppice/field/field_options.h"
#include "coppice/field/kernel/ball_chain.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/measure/volume_report.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/fit_volume.h"
#include "coppice/points/point_set.h"
#include "coppice/ramification/ramification.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "coppice/tubes/cylinders.h"

namespace coppice {

/// How a skeleton becomes a surface.
enum class MeshMethod {
    quads,          ///< a cage about the skeleton, subdivided and moved onto the field [Zhu2015]
    tetrahedra,     ///< triangles where the field has its level, found in tetrahedra [Zhu2013]
    cylinders,      ///< a tube for every axis, not joined to the others [Huang2017]
    ramifications,  ///< units at forks, connected or pasted, subdivided and moved onto the field [Huang2017]
    bmesh,          ///< as quads, but moved onto metaballs [Ji2010], which [Zhu2015] compares with
};

template <>
struct EnumNames<MeshMethod> {
    static constexpr std::array<std::string_view, 5> names{"quads", "tetrahedra", "cylinders",
                                                           "ramifications", "bmesh"};
};

/// What of its skeleton a surface keeps.
enum class Fit {
    surface,   ///< its vertices lie on the field, of radii at which rings have the area of the circles meant
    volume,    ///< it encloses the volume of the skeleton's rounded cones, part by part
    automatic  ///< as `surface`, but quads as `volume` where that would leave the volume off
};

template <>
struct EnumNames<Fit> {
    static constexpr std::array<std::string_view, 3> names{"surface", "volume", "automatic"};
};

/// What becomes of branches that run through each other.
enum class Overlaps {
    merge,  ///< they become one body where the axis of one runs inside the other
    graft,  ///< what enters another branch is cut off there, and what comes out of it springs from there
    apart,  ///< trees are bent apart, so that each keeps its wood; within a tree as graft
    keep,   ///< they cross, and so do their quads
};

template <>
struct EnumNames<Overlaps> {
    static constexpr std::array<std::string_view, 4> names{"merge", "graft", "apart", "keep"};
};

/// What tetrahedra the method `tetrahedra` begins with.
enum class TetraBase {
    octree,     ///< those of a lattice, as fine as the local radius asks for
    polyhedron  ///< those of a polyhedron about the branches, a handful for each segment [Zhu2013]
};

template <>
struct EnumNames<TetraBase> {
    static constexpr std::array<std::string_view, 2> names{"octree", "polyhedron"};
};

/// How large the triangles of the method `tetrahedra` are, and how exactly they lie.
struct TetraOptions {
    TetraBase base = TetraBase::octree;  ///< what is cut into eight
    float edge = 0.5f;                   ///< [radii] length of the triangles' edges, about
    /// More levels are faster for short edges, but grade less finely. A polyhedron, whose tetrahedra are as
    /// wide as its sections, is cut as often as `edge` asks for, whatever the levels: see polyhedron_levels.
    MarchOptions march{.levels = 1};
};

/// Times that tetrahedra of a polyhedron three radii wide are cut, to come nearest to `edge`: three times at
/// the default edge, as printed, and once at least. Throws InvalidInput naming `edge` when that is more than
/// five times.
int polyhedron_levels(const TetraOptions& options);

template <class Self, class Visitor>
requires SameOptions<Self, TetraOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"tetra_base",
                "what is cut into tetrahedra: an octree about the branches, or a polyhedron around them, a "
                "handful for each segment, cut in eight as often as edge asks for"},
          o.base);
    visit(common_field("edge", "Approximate edge length of the triangles of the method tetrahedra",
                       Unit::radius, 0.05, 4),
          o.edge);
    visit(Field{"tetra_levels", "times the tetrahedra of an octree are cut into eight", Unit::none, 0, 4},
          o.march.levels);
    visit_accuracy_fields(o.march, visit);
}

/// Everything that decides what surface a skeleton gets. Tetrahedra are only concerned with prepare, field,
/// tetra, and the ends of control; cylinders only with levels, prepare, control and tube_sides. Surfaces that
/// are moved along with their skeleton have as many quads around all branches.
struct MeshOptions {
    MeshMethod method = MeshMethod::quads;  ///< quads, triangles, or tubes
    int levels =
        2;  ///< times the cage is subdivided, or the tetrahedra, which then are as much larger before
    Fit fit = Fit::surface;               ///< where vertices lie in the end
    Overlaps overlaps = Overlaps::merge;  ///< what becomes of branches that run through each other
    float graft = 0.6f;        ///< [sum of radii] branches whose axes come nearer than this overlap; 0 = none
    PrepareOptions prepare;    ///< what is done to the skeleton first
    ControlOptions control;    ///< the cage, and how branches end
    FieldOptions field;        ///< what surface the radii mean
    ProjectOptions project;    ///< how the cage is moved onto it
    UntangleOptions untangle;  ///< how folds are taken out
    int remesh_rounds = 12;    ///< times that quads which cross are looked for and remeshed; 0 = never
    TetraOptions tetra;        ///< for tetrahedra only
    RamificationOptions ramification;             ///< for ramifications only
    TubeSides tube_sides = TubeSides::automatic;  ///< faces around thin axes; not for tetrahedra
    /// [m] With sides by radius: how far the sides of sections may be from their circles; 0 = as far as those
    /// of the thickest axis, which has as many as the levels say. Quads only.
    float chord_error = 0;
    Device device = Device::automatic;  ///< where quads are subdivided and tetrahedra sampled
};

template <class Self, class Visitor>
requires SameOptions<Self, MeshOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("method",
                       "Kind of surface: quads along the branches, triangles of the level set, one tube per "
                       "axis, quads of ramification units, or quads on metaballs"),
          o.method);
    visit(common_field("levels", "Number of subdivisions of the control cage; each divides a quad into four",
                       Unit::none, 0, 6),
          o.levels);
    visit(common_field("fit",
                       "What the surface preserves: the areas of sections of branches, the volume of the "
                       "rounded cones of the skeleton, or automatically that of quads where it would be off"),
          o.fit);
    visit(
        common_field("overlaps",
                     "Treatment of branches that run through each other: both are merged into one body, one "
                     "is cut off and grafted onto the other, trees are bent apart, or they are kept"),
        o.overlaps);
    visit(Field{"graft",
                "branches whose axes come nearer than this times the sum of their radii overlap; 0 = none",
                Unit::none, 0, 1},
          o.graft);
    visit(Field{"prepare", "Preparing the skeleton"}, o.prepare);
    visit(Field{"control", "Control cage"}, o.control);
    visit(Field{"field", "Convolution field"}, o.field);
    visit(Field{"project", "Projection onto the field"}, o.project);
    visit(Field{"untangle", "Unfolding"}, o.untangle);
    visit(
        Field{"remesh_rounds", "times at most that quads which cross are looked for and remeshed; 0 = never",
              Unit::none, 0, 100},
        o.remesh_rounds);
    visit(Field{"tetra", "Tetrahedra"}, o.tetra);
    visit(Field{"ramification", "Ramifications"}, o.ramification);
    visit(
        Field{"tube_sides",
              "faces around thin branches: as many as around thick ones, fewer by the root of the radius (4 "
              "at least), or automatically fewer where a number of faces is given"},
        o.tube_sides);
    visit(Field{"chord_error",
                "distance of sides of sections from their circles with tube_sides by_radius; 0 = that around "
                "the thickest axis, which has as many sides as the levels say",
                Unit::metre, 0, 1e6},
          o.chord_error);
    visit(
        Field{
            "device",
            "where the surface is computed: on a graphics card where there is one and the surface is large, "
            "on the CPU, or on a card with CUDA"},
        o.device);
}

/// Returns the options of a surface that is written to a file: the volume is looked at, and mended.
inline MeshOptions options_of_written_surface() {
    MeshOptions options;
    options.fit = Fit::automatic;
    return options;
}

/// What became of a surface that got fewer quads around thin branches.
struct CoarsenReport {
    std::uint64_t faces_before = 0;  ///< with as many around all
    std::uint32_t raised = 0;  ///< times that a node got more sides, since quads crossed or were inverted
};

/// What remeshing did at knots, where tubes cross each other or themselves.
struct KnotReport {
    std::uint64_t pairs_before = 0;  ///< of quads that crossed
    std::uint64_t pairs_after = 0;   ///< of quads that still do
    std::uint32_t lossy = 0;         ///< rows of quads that left out something thick
    std::uint32_t severed = 0;       ///< rows of quads that severed an axis
    std::uint32_t folded = 0;        ///< quads that stayed folded
    std::uint32_t rounds = 0;        ///< of remeshing
    std::uint32_t slices = 0;        ///< rows of quads around tubes that were replaced
    std::uint64_t parts = 0;         ///< of the surface, remeshed or not
    std::int64_t handles = 0;        ///< of all parts: the Euler number is 2 (parts - handles)
};

/// The metaballs that a surface was moved onto.
struct BallReport {
    std::uint64_t balls = 0;  ///< of all segments
    BallChain chain;          ///< how they stand, and how smooth that is
};

/// What a surface was computed on.
struct DeviceUse {
    std::string name = "CPU";  ///< that, or what the card is called
    std::string note;          ///< where a card was asked for and did not do it, why: a sentence
};

/// What MeshMethod::quads, MeshMethod::ramifications and MeshMethod::bmesh make.
struct QuadSurface {
    QuadMesh mesh;             ///< of at least one face
    ControlMesh cage;          ///< the quads before subdivision; of ramifications, before the second one
    GraftReport grafted;       ///< branches that run through each other
    PartReport parted;         ///< branch nodes that were moved
    ProjectReport projected;   ///< how near the field's level the vertices are
    UntangleReport untangled;  ///< folds found and taken out
    KnotReport knots;          ///< crossings found and remeshed
    std::optional<CoarsenReport> coarsened;      ///< where options.tube_sides was by_radius
    std::optional<RamificationReport> ramified;  ///< how ramifications were joined
    std::optional<BallReport> balls;             ///< where the kernel was balls
    DeviceUse device;                            ///< what refined and projected it
};

/// What MeshMethod::tetrahedra makes.
struct TetraSurface {
    TriMesh mesh;                                ///< of at least one face
    SolidMesh solid;                             ///< the tetrahedra inside; empty but from mesh_solid
    MarchReport march;                           ///< of the tetrahedra
    std::uint32_t coarse = 0;                    ///< tetrahedra before they are cut into eight
    std::uint32_t grown = 0;                     ///< times more tetrahedra were taken to enclose the surface
    std::optional<PolyhedronReport> polyhedron;  ///< where tetra.base asked for one
    DeviceUse device;                            ///< what sampled the tetrahedra
};

/// A surface, and what every stage did.
struct MeshResult {
    std::variant<QuadSurface, TetraSurface, CylinderMesh> surface;  ///< of its method
    PrepareReport prepared;                                         ///< changes to the skeleton
    std::optional<BendApartReport> bent_apart;                      ///< where options.overlaps asked for it
    std::optional<GlobalWeights> weights;  ///< where options.field.weights asked for it
    /// Of the surface before fitting and of the cones, measured by some 2^15 points where options.fit is
    /// automatic and has to know.
    std::optional<VolumeReport> measured;
    std::optional<FitVolumeReport> fitted;  ///< where the surface was moved to enclose the volume
    std::vector<std::pair<std::string, double>> stages;  ///< name, seconds

    /// The surface of quads; std::bad_variant_access when the method was another.
    const QuadSurface& quads() const { return std::get<QuadSurface>(surface); }
    QuadSurface& quads() { return std::get<QuadSurface>(surface); }  ///< the same, to change

    /// The surface of triangles; std::bad_variant_access when the method was another.
    const TetraSurface& tetrahedra() const { return std::get<TetraSurface>(surface); }
    TetraSurface& tetrahedra() { return std::get<TetraSurface>(surface); }  ///< the same, to change

    /// The tubes; std::bad_variant_access when the method was another.
    const CylinderMesh& cylinders() const { return std::get<CylinderMesh>(surface); }
};

/// The faces of a surface, whichever method made it. O(n).
PolygonMesh to_polygons(const MeshResult& result);

/// Wraps a skeleton in one closed surface of quads, one sphere per tree that does not run through another:
/// prepares the skeleton, merges branches that run through each other, finds where branches part, builds a
/// coarse cage, subdivides it, moves it onto the convolution field, and unfolds what was folded [Zhu2015].
/// Where quads still cross, or from two levels on sever an axis, the tubes there are replaced by quads made
/// of the triangles that tetrahedra find, which never cross and hold all axes; branches that touch there
/// become one body, and a loop of such branches is a handle of the surface. Levels 0 and open bases are not
/// looked at. Trees that run through each other are merged too; with `overlaps` apart they are bent apart
/// first (see bend_apart), and the surface is that of the bent skeleton.
///
/// About 70 quads per segment at two levels. O(n log n); memory: at most 120 bytes per quad above the input.
///
/// Or, with tetrahedra, wraps it in triangles, as large as the local radius asks for: prepares the skeleton,
/// puts a lattice of tetrahedra about it, and finds the surface in them. Branches that cross or touch become
/// one body: the surface is closed, manifold and never crosses itself, but may have handles. It has a part
/// for each tree, whatever the options, or fewer where trees touch. Or, with tetra.base polyhedron, puts the
/// bounding polyhedron of [Zhu2013] about the skeleton in place of the lattice.
///
/// Or, with ramifications, builds the cage by units at forks (see build_ramifications), which is subdivided
/// once less, moved onto the field, unfolded, and remeshed where quads cross as others are. Level 1 is not
/// looked at.
///
/// Or, with bmesh, takes the plain sum of metaballs for the field (kernel balls, blend 1, whatever is given)
/// and does all else as with quads.
///
/// Or, with cylinders, makes a tube for every axis of the prepared skeleton (see cylinders()): `sides` around
/// times two for each level, and two to the power of levels rows along each segment.
///
/// With `fit` volume, either of the closed surfaces is moved at the end so that it encloses the volume of the
/// skeleton's rounded cones (see fit_volume). With `automatic` its volume is measured (some 20 ms), and it is
/// moved where that is off by over half a percent beyond the error and moving makes it better; without levels
/// always, unless that ends farther off. Triangles, cylinders, and quads on metaballs, with an open base,
/// global weights or a radius_scale of their own stay as they are.
///
/// Throws InvalidInput naming an option out of range, a node at which more than 256 branches begin (but for
/// cylinders), or `levels` when the mesh would be too large to index, and when tetrahedra find no surface
/// because it is thinner than they are, `fit` when it is not surface for cylinders, and `kernel` when it is
/// neither quartic nor balls for bmesh.
MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// The same with global weights that are fitted to these points of the surface; chosen ones where there are
/// none. Unused for local weights.
MeshResult mesh_skeleton(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx = {});

/// The same by tetrahedra, with those inside the surface, for finite elements (TetraSurface::solid): they
/// share whole faces, grow with the local radius, and their vertices begin with those of the surface, whose
/// triangles are all that is left over. Memory: some 40 bytes more for each tetrahedron of the finest level.
///
/// Throws as above, and InvalidInput naming `method` or `fit` when it is not tetrahedra, or not surface.
MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options = {},
                      const Context& ctx = {});

}  // namespace coppice
