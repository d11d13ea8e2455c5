#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/field_options.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

/// Record of the refined quads that remeshing replaced, by tube rows: the quads between two successive rings
/// of a tube, numbered tube by tube from its beginning to its end. Kept quads come first in the mesh, in
/// their order, and so do their vertices; then the quads and vertices of the repair patches follow, patch by
/// patch.
struct RemeshTrace {
    /// A repair patch that replaces some rows.
    struct RepairPatch {
        std::vector<std::uint32_t> tube_rows;  ///< ascending
        std::uint32_t quads = 0;               ///< number of its quads
        std::vector<std::uint32_t> adjacent;   ///< kept rows at its cut rings
        std::vector<NodeId> segments;  ///< all segments of the field's skeleton from which it was made
    };
    std::vector<std::uint8_t> is_gone;        ///< per row; empty if all rows are kept
    std::vector<std::uint32_t> gone;          ///< removed refined vertices, ascending
    std::vector<RepairPatch> repair_patches;  ///< in the order of their quads
    /// Whether the result at each location depends only on its neighbourhood: false if zones or whole trees
    /// were removed, or rows were excluded.
    bool is_local = true;

    /// Returns whether a row is kept.
    bool stays(std::uint32_t row) const { return is_gone.empty() || is_gone[row] == 0; }
    /// Returns the kept ones of this number of refined vertices, ascending: the first vertices of the mesh.
    std::vector<std::uint32_t> kept_vertices(std::uint32_t count) const;
};

/// The quads that replaced the kept refined quads of a surface with fewer quads around thin branches. They
/// come first in the mesh, before the repair patches.
struct CoarseQuads {
    std::vector<Quad> quads;               ///< of refined vertices
    std::vector<std::uint32_t> cage_quad;  ///< per quad: its cage quad; of a transition the first one
};

/// The intermediate results of a surface of quads, for callers that move its skeleton and recompute the same
/// quads.
struct QuadBuild {
    MeshOptions options;  ///< the given ones; of bmesh those of quads, of ramifications with 4 sides
    FieldOptions field;   ///< of the convolution field around `skeleton`
    std::optional<GlobalWeights> weights;  ///< if field.weights is global

    Skeleton skeleton;  ///< skeleton of the field: prepared, and branches grafted
    Skeleton tubes;     ///< tubes of the cage: a tube is identified by its child node, a ball by its node
    /// Per node of `skeleton`: the node of the prepared skeleton of its segment.
    std::vector<NodeId> prepared_node;
    std::vector<NodeId> tube;         ///< per node of `skeleton`: see TubeTree; empty for ramifications
    CompressedRows<NodeId> wrapping;  ///< per node of `skeleton`: the tubes around its segment, in order
    /// Per tube the range of parameters of its axis along which its quads are; empty if all are whole.
    std::vector<std::array<float, 2>> sides;

    ControlMesh cage;            ///< regions are tubes, and their nodes are those of `skeleton`
    PatchRefinement refinement;  ///< from the cage to the refined quads
    Buffer<Vec3> anchors;        ///< [m] per refined vertex
    Buffer<Vec3> refined;        ///< [m] position per refined vertex, on the field, before remeshing
    RemeshTrace remeshed;        ///< from the refined quads to the mesh
    CoarseQuads coarse;          ///< if there are fewer quads around thin branches
};

/// Builds a surface of quads that is only a refined cage on the field: folds are not removed, and quads that
/// cross are not remeshed, because both would change the quads while the skeleton moves. Throws the
/// exceptions of mesh_skeleton(), and InvalidInput naming `method`, `weights` or `fit` if they are not quads
/// or bmesh, local, and surface.
QuadBuild build_quads(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// Sets the regions of a field around the skeleton of a surface to those of the surface at rest.
void set_regions(ConvolutionField& field, const QuadBuild& build, const Context& ctx = {});

}  // namespace coppice
