#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/cage/cage.h"
#include "coppice/cage/cylinders.h"
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

namespace coppice {

/// Method that builds a surface from a skeleton.
enum class MeshMethod {
    quads,          ///< a cage around the skeleton, subdivided and moved onto the field [Zhu2015]
    tetrahedra,     ///< triangles of the iso surface of the field, found in tetrahedra [Zhu2013]
    cylinders,      ///< a separate tube for every axis [Huang2017]
    ramifications,  ///< units at forks, connected or pasted, subdivided and moved onto the field [Huang2017]
    bmesh,          ///< as quads, but moved onto metaballs [Ji2010], the comparison of [Zhu2015]
};

template <>
struct EnumNames<MeshMethod> {
    static constexpr std::array<std::string_view, 5> names{"quads", "tetrahedra", "cylinders",
                                                           "ramifications", "bmesh"};
};

/// Property of the skeleton that a surface preserves.
enum class Fit {
    surface,   ///< vertices are on the field, with radii at which rings have the areas of the specified
               ///< circles
    volume,    ///< the surface encloses the volume of the skeleton's rounded cones, locally and as a whole
    automatic  ///< as `surface`, but quads as `volume` if their volume would deviate
};

template <>
struct EnumNames<Fit> {
    static constexpr std::array<std::string_view, 3> names{"surface", "volume", "automatic"};
};

/// Treatment of branches that intersect each other.
enum class Overlaps {
    merge,  ///< they are merged into one body if the axis of one runs inside the other
    graft,  ///< the section that enters another branch is cut off, and the section that leaves it is attached
            ///< there
    apart,  ///< trees are bent apart, so that each keeps its branches; within a tree as graft
    keep,   ///< they are kept and cross, and so do their quads
};

template <>
struct EnumNames<Overlaps> {
    static constexpr std::array<std::string_view, 4> names{"merge", "graft", "apart", "keep"};
};

/// Initial tetrahedra of the method `tetrahedra`.
enum class TetraBase {
    octree,     ///< a lattice, as fine as the local radius requires
    polyhedron  ///< a polyhedron around the branches, a few tetrahedra for each segment [Zhu2013]
};

template <>
struct EnumNames<TetraBase> {
    static constexpr std::array<std::string_view, 2> names{"octree", "polyhedron"};
};

/// Size and accuracy of the triangles of the method `tetrahedra`.
struct TetraOptions {
    TetraBase base = TetraBase::octree;  ///< initial tetrahedra, each of which is cut into eight
    float edge = 0.5f;                   ///< [radii] approximate edge length of the triangles
    /// More levels are faster for short edges, but grade less finely. The tetrahedra of a polyhedron are as
    /// wide as its sections and are cut as often as `edge` requires, independent of the levels: see
    /// polyhedron_levels.
    MarchOptions march{.levels = 1};
};

/// Returns the number of times that tetrahedra of a polyhedron three radii wide are cut to come closest to
/// `edge`: three at the default edge, as published, and at least one. Throws InvalidInput naming `edge` if it
/// is more than five.
int polyhedron_levels(const TetraOptions& options);

/// Lists the members for front ends.
void list_fields(TetraOptions& o, FieldList& list);

/// Options of the surface of a skeleton. Tetrahedra only use prepare, field, tetra, and the ends of control;
/// cylinders only levels, prepare, control and tube_sides. Surfaces that are moved along with their skeleton
/// have the same number of quads around all branches.
struct MeshOptions {
    MeshMethod method = MeshMethod::quads;  ///< kind of faces: quads, triangles or tubes
    int levels = 2;          ///< number of subdivisions of the cage, or of the tetrahedra, which begin larger
    Fit fit = Fit::surface;  ///< property that the final positions of the vertices preserve
    Overlaps overlaps = Overlaps::merge;  ///< treatment of branches that intersect each other
    float graft = 0.6f;      ///< [sum of radii] branches with axes closer than this overlap; 0 = no overlaps
    PrepareOptions prepare;  ///< preparation of the skeleton
    ControlOptions control;  ///< the cage, and the ends of branches
    FieldOptions field;      ///< the surface that the radii specify
    ProjectOptions project;  ///< projection of the cage onto the field
    UntangleOptions untangle;          ///< removal of folds
    int remesh_rounds = 12;            ///< maximum number of rounds that find and remesh crossing quads
    TetraOptions tetra;                ///< used by tetrahedra only
    RamificationOptions ramification;  ///< used by ramifications only
    TubeSides tube_sides = TubeSides::automatic;  ///< faces around thin axes; not for tetrahedra
    /// [m] With sides by radius: maximum distance of the sides of sections from their circles; 0 = the
    /// distance at the thickest axis, where the levels determine the number of sides. Quads only.
    float chord_error = 0;
    Device device = Device::automatic;  ///< device that subdivides quads and samples tetrahedra
};

/// Lists the members for front ends.
void list_fields(MeshOptions& o, FieldList& list);

/// Returns the options of a surface that is written to a file: its volume is measured and repaired.
inline MeshOptions options_of_written_surface() {
    MeshOptions options;
    options.fit = Fit::automatic;
    return options;
}

/// Effects of fewer quads around thin branches.
struct CoarsenReport {
    std::uint64_t faces_before = 0;  ///< number of quads with the same number of sides everywhere
    std::uint32_t raised = 0;  ///< times that a node got more sides because quads crossed or were inverted
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const CoarsenReport& r, Visitor&& visit) {
    visit("quads_before", r.faces_before);
    visit("nodes_refined", r.raised);
}

/// Results of remeshing at self-intersections, where tubes cross each other or themselves.
struct RemeshReport {
    std::uint64_t pairs_before = 0;  ///< pairs of quads that crossed
    std::uint64_t pairs_after = 0;   ///< pairs of quads that still cross
    std::uint32_t lost_bulges = 0;   ///< rows of quads that left out a thick part of the skeleton
    std::uint32_t severed = 0;       ///< rows of quads that severed an axis
    std::uint32_t folded = 0;        ///< quads that remained folded
    std::uint32_t rounds = 0;        ///< rounds of remeshing
    std::uint32_t tube_rows = 0;     ///< rows of quads around tubes that were replaced
    std::uint64_t parts = 0;         ///< components of the surface, remeshed or not
    std::int64_t handles = 0;        ///< handles of all components: the Euler number is 2 (parts - handles)
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const RemeshReport& r, Visitor&& visit) {
    visit("pairs_before", r.pairs_before);
    visit("pairs_after", r.pairs_after);
    visit("lost_bulges", r.lost_bulges);
    visit("severed", r.severed);
    visit("folded", r.folded);
    visit("rounds", r.rounds);
    visit("tube_rows", r.tube_rows);
}

/// The metaballs of the field that a surface was moved onto.
struct BallReport {
    std::uint64_t balls = 0;  ///< number of balls of all segments
    BallChain chain;          ///< their spacing, and the resulting smoothness
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const BallReport& r, Visitor&& visit) {
    visit("balls", r.balls);
    visit("spacing", r.chain.spacing);
    visit("radius_at_balls", r.chain.at_balls);
    visit("radius_between", r.chain.between);
}

/// The device that computed a surface.
struct DeviceUse {
    std::string name = "CPU";  ///< the CPU, or the name of the GPU
    std::string note;          ///< reason, as a sentence, if a GPU was requested but not used
};

/// Result of MeshMethod::quads, MeshMethod::ramifications and MeshMethod::bmesh.
struct QuadSurface {
    QuadMesh mesh;             ///< vertices of at least one face
    ControlMesh cage;          ///< quads before subdivision; of ramifications, before the second subdivision
    GraftReport grafted;       ///< branches that intersect each other
    PartReport parted;         ///< branch nodes that were moved
    ProjectReport projected;   ///< distances of the vertices from the iso value of the field
    UntangleReport untangled;  ///< folds found and removed
    RemeshReport repair;       ///< crossings found and remeshed
    std::optional<CoarsenReport> coarsened;      ///< if options.tube_sides was by_radius
    std::optional<RamificationReport> ramified;  ///< joints of ramifications
    std::optional<BallReport> balls;             ///< if the kernel was balls
    DeviceUse device;                            ///< device that refined and projected the surface
};

/// Result of MeshMethod::tetrahedra.
struct TetraSurface {
    TriMesh mesh;              ///< vertices of at least one face
    SolidMesh solid;           ///< tetrahedra inside the surface; empty except from mesh_solid
    MarchReport march;         ///< statistics of the tetrahedra
    std::uint32_t coarse = 0;  ///< number of tetrahedra before they are cut into eight
    std::uint32_t grown = 0;   ///< number of times that tetrahedra were added to enclose the surface
    std::optional<PolyhedronReport> polyhedron;  ///< if tetra.base is polyhedron
    DeviceUse device;                            ///< device that sampled the tetrahedra
};

/// A surface, and the reports of all stages.
struct MeshResult {
    std::variant<QuadSurface, TetraSurface, CylinderMesh> surface;  ///< the surface, by method
    PrepareReport prepared;                                         ///< changes to the skeleton
    std::optional<BendApartReport> bent_apart;                      ///< if options.overlaps is apart
    std::optional<GlobalWeights> weights;                           ///< if options.field.weights is global
    /// Volumes of the surface before fitting and of the cones, estimated from about 2^15 points if
    /// options.fit is automatic and depends on them.
    std::optional<VolumeReport> measured;
    std::optional<FitVolumeReport> fitted;               ///< if the surface was fitted to the volume
    std::vector<std::pair<std::string, double>> stages;  ///< names and seconds

    /// Returns the surface of quads. Throws std::bad_variant_access if the method is another.
    const QuadSurface& quads() const { return std::get<QuadSurface>(surface); }
    QuadSurface& quads() { return std::get<QuadSurface>(surface); }  ///< mutable access

    /// Returns the surface of triangles. Throws std::bad_variant_access if the method is another.
    const TetraSurface& tetrahedra() const { return std::get<TetraSurface>(surface); }
    TetraSurface& tetrahedra() { return std::get<TetraSurface>(surface); }  ///< mutable access

    /// Returns the tubes. Throws std::bad_variant_access if the method is another.
    const CylinderMesh& cylinders() const { return std::get<CylinderMesh>(surface); }
};

/// Returns the faces of a surface of any method. O(n).
PolygonMesh to_polygons(const MeshResult& result);

/// Wraps a skeleton in one closed surface of quads, one sphere per tree that does not intersect another:
/// prepares the skeleton, merges branches that intersect each other, finds the ramifications, builds a coarse
/// cage, subdivides it, moves it onto the convolution field, and unfolds folded quads [Zhu2015]. Where quads
/// still cross, or from two levels on sever an axis, the tubes are replaced by quads made from the triangles
/// of tetrahedra, which never intersect and contain all axes; branches that touch there become one body, and
/// a loop of such branches is a handle of the surface. Level 0 and open bases are not checked. Trees that
/// intersect each other are merged too; with `overlaps` apart they are bent apart first (see bend_apart), and
/// the surface is that of the bent skeleton.
///
/// About 70 quads per segment at two levels. O(n log n); memory: at most 120 bytes per quad in addition to
/// the input.
///
/// With tetrahedra, wraps the skeleton in triangles, as large as the local radius allows: prepares the
/// skeleton, puts a lattice of tetrahedra around it, and finds the surface in them. Branches that cross or
/// touch become one body: the surface is closed, manifold and never intersects itself, but may have handles.
/// It has one component for each tree, for any options, or fewer if trees touch. With tetra.base polyhedron,
/// the bounding polyhedron of [Zhu2013] replaces the lattice.
///
/// With ramifications, builds the cage from units at forks (see build_ramifications), which is subdivided
/// once less, moved onto the field, unfolded, and remeshed where quads cross, as for quads. Level 1 is not
/// checked.
///
/// With bmesh, the field is the plain sum of metaballs (kernel balls, blend 1, for any given values);
/// everything else is done as with quads.
///
/// With cylinders, creates a tube for every axis of the prepared skeleton (see cylinders()): `sides` around,
/// doubled for each level, and two to the power of levels rows along each segment.
///
/// With `fit` volume, each of the closed surfaces is finally moved so that it encloses the volume of the
/// skeleton's rounded cones (see fit_volume). With `automatic` its volume is measured (about 20 ms), and it
/// is moved if the volume deviates by more than half a percent beyond the error and moving improves it;
/// without levels always, unless the result deviates more. Triangles, cylinders, quads on metaballs, and
/// quads with an open base, global weights or a radius_scale stay unchanged.
///
/// Throws InvalidInput naming an option out of range, a node at which more than 256 branches begin (except
/// for cylinders), `levels` if the mesh would be too large to index, `fit` if it is not surface for
/// cylinders, and `kernel` if it is neither quartic nor balls for bmesh; and if tetrahedra find no surface
/// because it is thinner than they are.
MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// The same with global weights that are fitted to these points of the surface, or to chosen points if there
/// are none. The points are ignored for local weights.
MeshResult mesh_skeleton(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx = {});

/// The same by tetrahedra, including those inside the surface, for finite elements (TetraSurface::solid):
/// they share whole faces, grow with the local radius, and their vertices begin with those of the surface;
/// the triangles of the surface are exactly their unshared faces. Memory: about 40 bytes more for each
/// tetrahedron of the finest level.
///
/// Throws as above, and InvalidInput naming `method` if it is not tetrahedra, or `fit` if it is not surface.
MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options = {},
                      const Context& ctx = {});

}  // namespace coppice
