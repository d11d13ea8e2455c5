#pragma once

#include <cstdint>
#include <span>

#include "coppice/subdivision/kernel/cage_view.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"

namespace coppice::cuda {

/// A cage that is to be subdivided and moved onto a field: what PatchRefinement, project and untangle are
/// given. All has to outlive what it is given to.
struct QuadJob {
    CageView cage;                          ///< its topology
    int levels = 2;                         ///< times that it is refined
    std::span<const Vec3> positions;        ///< [m] one per cage vertex
    std::span<const Vec3> anchors;          ///< [m] one per cage vertex
    std::span<const std::uint32_t> region;  ///< per cage quad: of the field
    std::span<const ClipPlane> clips;       ///< one per flat end, by first quad
    ProjectOptions project;                 ///< as for project()
    UntangleOptions untangle;               ///< as for untangle()
};

/// What was done to it.
struct QuadReport {
    ProjectReport projected;   ///< as from project()
    UntangleReport untangled;  ///< as from untangle()
};

/// What comes out of a job.
struct QuadCounts {
    std::uint32_t vertices;  ///< refined
    std::uint32_t quads;     ///< refined
};

/// Of a cage that is refined so many times. It must be one that PatchRefinement takes.
QuadCounts refined_counts(const CageView& cage, int levels);

}  // namespace coppice::cuda
