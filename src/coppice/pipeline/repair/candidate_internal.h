#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/measure/intersections.h"
#include "coppice/pipeline/repair/repair_patches_internal.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// The quads to check after some rows of a surface have been replaced by repair patches: quads of new
/// patches, and all quads near them.
struct CandidateQuads {
    std::vector<TubeRow> tube_row;            ///< per quad: its tube row, or none
    std::vector<std::uint32_t> repair_patch;  ///< per quad: its repair patch, or kNoIndex for a kept quad
    std::vector<std::uint32_t> number;        ///< per quad: its index in the mesh or the patch
    std::vector<std::uint32_t>
        cut_ring;                 ///< per quad: the cut ring of the band that contains it, or kNoIndex
    std::uint32_t first_new = 0;  ///< index of the first quad of a new patch
    PolygonMesh quads;            ///< geometry of all these quads

    std::uint32_t size() const { return static_cast<std::uint32_t>(tube_row.size()); }  ///< number of quads
};

/// Returns the part of the future mesh that has to be checked. The cost is proportional to the size of new
/// patches and their neighbourhood, plus O(tubes).
CandidateQuads candidate(const TubeQuads& before, const RemovedRows& removed,
                         const RepairPatches& repair_patches, const Context& ctx);

/// Returns the pairs of quads that intersect or touch and contain a new quad; in order, up to kMaxPairs.
std::vector<FacePair> new_crossings(const CandidateQuads& candidate, const Context& ctx);

}  // namespace coppice::pipeline_internal
