#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_origin_internal.h"
#include "coppice/pipeline/repair/repair_intersections_internal.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

/// Record of how a surface of quads was built, for callers that follow it through edits.
struct QuadTrace {
    std::optional<Skeleton> tubes;            ///< tubes of the cage
    std::vector<NodeId> segment;              ///< per tube: the node of the prepared skeleton of its segment
    std::vector<NodeId> field_segment;        ///< the same, per node of the field's skeleton
    std::optional<PatchRefinement> patches;   ///< from the cage to the refined quads
    Buffer<Vec3> refined;                     ///< positions of the refined vertices, before any were removed
    pipeline_internal::RemeshTrace remeshed;  ///< from these to the mesh
};

/// Optional outputs besides the surface.
struct QuadExtras {
    std::optional<GlobalWeights>& weights;                       ///< if options.field.weights is global
    std::optional<pipeline_internal::QuadRows>* rows = nullptr;  ///< for callers that move vertices later
    pipeline_internal::QuadOrigin* origin = nullptr;  ///< the same, with the skeleton; not for ramifications
    QuadTrace* trace = nullptr;
    /// Called with the refined surface before it is remeshed, and the trace so far; returns per tube whether
    /// it has to be checked.
    std::function<std::vector<std::uint8_t>(const QuadSurface&, const QuadTrace&)> wanted = {};
};

/// A cage and its tubes.
struct TubeCage {
    ControlMesh control;
    Skeleton tubes;
};

/// Returns only the cage of MeshMethod::quads.
TubeCage compute_cage(const Skeleton& prepared, const MeshOptions& options, const Context& ctx);

/// Implements MeshMethod::quads for a prepared skeleton.
QuadSurface mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                          const QuadExtras& extras, const Context& ctx, Stages& stages);

/// Implements MeshMethod::ramifications for a prepared skeleton; these are not traced.
QuadSurface mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                  const MeshOptions& options, const QuadExtras& extras, const Context& ctx,
                                  Stages& stages);

/// Throws InvalidInput naming a node at which more branches begin than a closed surface can join.
void check_branches(const Skeleton& s);

/// Returns the options of the quads that implement MeshMethod::bmesh. Throws InvalidInput naming a kernel
/// without balls.
MeshOptions on_metaballs(MeshOptions options);

}  // namespace coppice
