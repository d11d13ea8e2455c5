#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/cage/cylinders.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/separate_branches.h"
#include "coppice/edit/bend_apart.h"
#include "coppice/field/kernel/ball_chain.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/measure/volume_report.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/mesh/vertex_attribute.h"
#include "coppice/pipeline/fit_volume.h"
#include "coppice/ramification/ramification.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/polyhedron/polyhedron.h"

namespace coppice {

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
    bool is_searched = false;        ///< whether crossing quads were searched in the whole surface
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
    SeparationReport parted;   ///< branch nodes that were moved
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

/// Parts and density of an atlas. No two faces overlap; charts are two pixels apart.
struct AtlasReport {
    std::uint32_t charts = 0;     ///< number of parts with coordinates of their own
    double used = 0;              ///< share of the unit square that faces cover
    double pixels_per_metre = 0;  ///< mean density, in an image of the given size
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const AtlasReport& r, Visitor&& visit) {
    visit("charts", r.charts);
    visit("used", r.used);
    visit("pixels_per_metre", r.pixels_per_metre);
}

/// A surface, and the reports of all stages.
struct MeshResult {
    std::variant<QuadSurface, TetraSurface, CylinderMesh> surface;  ///< the surface, by method
    PrepareReport prepared;                                         ///< changes to the skeleton
    std::optional<BendApartReport> bent_apart;                      ///< if options.overlaps is apart
    std::optional<GlobalWeights> weights;                           ///< if options.field.weights is global
    /// Volumes of the surface before fitting and of the cones, estimated from about 2^15 points if
    /// options.fit is automatic and depends on them.
    std::optional<VolumeReport> measured;
    std::optional<FitVolumeReport> fitted;  ///< if the surface was fitted to the volume
    /// If options.texture has coordinates. The densities of an atlas are relative to the mean, and the faces
    /// that are projected are on planes of charts.
    std::optional<Texture> texture;
    std::optional<AtlasReport> atlas;  ///< if these coordinates are an atlas
    std::vector<std::uint32_t> slots;  ///< the MaterialSlot of each face as a number, if options.slots has
                                       ///< twigs or cuts; otherwise empty
    /// If options.attributes: `order` and `branch`, the order and the number of the branch as in
    /// list_branches() of the prepared skeleton, `distance` [m] along it from its beginning, and `radius` [m]
    /// of the skeleton there; otherwise empty.
    std::vector<VertexAttribute> attributes;
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

}  // namespace coppice
