#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/fan_kernel.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/march/samples_view.h"

namespace coppice {

/// A fine vertex that would be moved.
struct MovedVertex {
    std::uint32_t vertex;  ///< fine
    Vec3 position;         ///< [m] where to
    float way;             ///< [m] how far
};

/// A held vertex that the field puts outside or near to the surface.
struct ShallowVertex {
    std::uint32_t vertex;  ///< fine
    std::uint32_t region;  ///< of a tetrahedron that has it
    Vec3 position;         ///< [m]
    float reach;           ///< [m] how far it may be moved
    float height;          ///< of the profile
};

/// What sampling finds.
struct SampledVertices {
    /// Vertices that are not as most are.
    struct Found {
        std::vector<MovedVertex> near;       ///< not held, where they would come to lie on the surface
        std::vector<ShallowVertex> shallow;  ///< held; those of a region one after the other
    };
    /// Of the profile, of every fine vertex, -1 for those of no tetrahedron; empty if who samples keeps them.
    Buffer<float> height;
    std::vector<std::uint64_t> above;  ///< a bit for each that is above 0
    std::vector<Found> found;          ///< in pieces, in any order
};

/// What extraction makes.
struct StagedSurface {
    TriMesh mesh;               ///< see MarchStages::extract
    std::uint64_t crossed = 0;  ///< fine tetrahedra that it passes through
};

/// The stages of march() that look at all fine vertices or tetrahedra, as something else than the CPU does
/// them: see coppice/cuda/tetra. They are called in the order in which they stand here, and of the samples
/// nothing but `inside`, `on` and `moved` changes between them.
class MarchStages {
  public:
    virtual ~MarchStages() = default;

    /// Samples all fine vertices, and finds those near the surface by the formulas of snap_kernel.h; `held`
    /// has a bit for each.
    virtual SampledVertices sample(const TetraRefinement& refinement, float snap,
                                   tetra_kernel::BitsView held) = 0;

    /// Of every fine tetrahedron that has turned over, or has become too flat, the vertex that moved
    /// farthest, by the formulas of fold_kernel.h. Ascending, each once.
    virtual std::vector<std::uint32_t> find_folds(const tetra_kernel::SamplesView& samples) = 0;

    /// What the triangles around vertices on the surface make, by rank in SamplesView::placed: see ListedFan.
    virtual std::vector<tetra_kernel::Fan> find_fans(const tetra_kernel::SamplesView& samples) = 0;

    /// The surface that these signs make: vertices moved onto it first, `placed_count` of them, then those of
    /// cut edges in the order of FineNumbers, found by the formulas of cut_edge_kernel.h; triangles by fine
    /// tetrahedron. `placed` has the number of a vertex that was moved, by rank in SamplesView::placed.
    virtual StagedSurface extract(const tetra_kernel::SamplesView& samples,
                                  std::span<const std::uint32_t> placed, std::uint32_t placed_count,
                                  int refinements) = 0;
};

/// march() about axes, with stages done elsewhere. `field` is what they sample, too: the few held vertices
/// near the surface are sampled here. Throws what the stages throw.
MarchResult march(const TetraMesh& mesh, FieldRef field, const InsideAxes& axes, const MarchOptions& options,
                  MarchStages& stages, const Context& ctx = {});

}  // namespace coppice
