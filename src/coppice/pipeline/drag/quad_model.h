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

/// A surface of quads together with all that it was made of, for those who move its skeleton and make the
/// same quads anew: the cage is refined and moved onto the field, and that is all. Folds are not taken out,
/// and quads that cross are not remeshed, for both would change the quads.
struct QuadModel {
    MeshOptions options;       ///< those given; of bmesh the ones that it stands for
    FieldOptions field;        ///< of the convolution field about `skeleton`
    ControlMesh control;       ///< cage, anchors, and the tube that each quad is of; regions are tubes
    QuadMesh rest;             ///< the refined quads, on the field, in the order of PatchRefinement
    Skeleton skeleton;         ///< that has the field: prepared, and branches grafted
    Skeleton tubes;            ///< that the cage was built about: see TubeTree
    std::vector<NodeId> tube;  ///< per node of `skeleton`: see TubeTree
};

/// Makes the surface and keeps what it was made of. Throws what mesh_skeleton() throws, and InvalidInput
/// naming `method`, `weights` or `fit` where they are not quads or bmesh, local, and surface.
QuadModel quad_model(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// Gives a field about the model's skeleton the regions of its surface at rest.
void set_regions(ConvolutionField& field, const QuadModel& model, const Context& ctx = {});

}  // namespace coppice
