#pragma once

#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/field_options.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A surface of quads with its inputs, for callers that move its skeleton and recompute the same quads: the
/// cage is only refined and moved onto the field. Folds are not removed, and quads that cross are not
/// remeshed, because both would change the quads.
struct QuadModel {
    MeshOptions options;       ///< the given options; of bmesh the equivalent ones of quads
    FieldOptions field;        ///< of the convolution field around `skeleton`
    ControlMesh control;       ///< cage, anchors, and the tube of each quad; regions are tubes
    QuadMesh rest;             ///< the refined quads, on the field, in the order of PatchRefinement
    Skeleton skeleton;         ///< skeleton of the field: prepared, and branches grafted
    Skeleton tubes;            ///< tubes of the cage: see TubeTree
    std::vector<NodeId> tube;  ///< per node of `skeleton`: see TubeTree
};

/// Builds the surface and keeps its inputs. Throws the exceptions of mesh_skeleton(), and InvalidInput naming
/// `method`, `weights` or `fit` if they are not quads or bmesh, local, and surface.
QuadModel quad_model(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// Sets the regions of a field around the model's skeleton to those of its surface at rest.
void set_regions(ConvolutionField& field, const QuadModel& model, const Context& ctx = {});

}  // namespace coppice
