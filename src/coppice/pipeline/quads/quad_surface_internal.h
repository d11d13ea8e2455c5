#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/knots/remesh_knots_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_origin_internal.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

/// How a surface of quads came about, for those who follow it through edits.
struct QuadTrace {
    std::optional<Skeleton> tubes;  ///< those that the cage was built about
    std::vector<NodeId> segment;    ///< per tube: the node of the prepared skeleton whose segment it is about
    std::vector<NodeId> field_segment;        ///< the same, per node of the field's skeleton
    std::optional<PatchRefinement> patches;   ///< from the cage to the refined quads
    Buffer<Vec3> refined;                     ///< positions of the refined vertices, before any went
    pipeline_internal::RemeshTrace remeshed;  ///< from these to the mesh
};

/// What some want to know besides the surface.
struct QuadExtras {
    std::optional<GlobalWeights>& weights;                       ///< where options.field.weights asks for it
    std::optional<pipeline_internal::QuadRows>* rows = nullptr;  ///< for those who move vertices later on
    pipeline_internal::QuadOrigin* origin = nullptr;  ///< likewise, with the skeleton; not for ramifications
    QuadTrace* trace = nullptr;
    /// Called with the refined surface before it is remeshed, and what is traced so far: per tube, whether it
    /// has to be looked at.
    std::function<std::vector<std::uint8_t>(const QuadSurface&, const QuadTrace&)> wanted = {};
};

/// A cage and the tubes it was built about.
struct TubeCage {
    ControlMesh control;
    Skeleton tubes;
};

/// The cage alone of MeshMethod::quads.
TubeCage cage_of(const Skeleton& prepared, const MeshOptions& options, const Context& ctx);

/// MeshMethod::quads of a prepared skeleton.
QuadSurface mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                          const QuadExtras& extras, const Context& ctx, Stages& stages);

/// MeshMethod::ramifications of a prepared skeleton; these are not traced.
QuadSurface mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                  const MeshOptions& options, const QuadExtras& extras, const Context& ctx,
                                  Stages& stages);

/// Throws InvalidInput naming a node at which more branches begin than a closed surface can join.
void check_branches(const Skeleton& s);

/// The quads that MeshMethod::bmesh stands for. Throws InvalidInput naming a kernel that has no balls.
MeshOptions on_metaballs(MeshOptions options);

}  // namespace coppice
