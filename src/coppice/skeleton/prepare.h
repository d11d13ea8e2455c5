#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/resample.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What is done to a skeleton before a surface is made of it.
struct PrepareOptions {
    float merge_branches = 0.5f;  ///< [radius] branch nodes nearer than this become one; 0 = never; in [0, 2]
    int smooth_passes = 0;        ///< times that radii are averaged along axes; in [0, 1000]
    ResampleOptions resample;     ///< how the nodes between branch nodes are chosen
    int max_children = 0;         ///< nodes with more children are split; 0 = never, else in [2, 1000]
};

template <class Self, class Visitor>
requires SameOptions<Self, PrepareOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"merge_branches", "Distance below which two branch nodes become one; 0 = never", Unit::radius,
                0, 2},
          o.merge_branches);
    visit(Field{"smooth_passes", "Times that radii are averaged along branches", Unit::none, 0, 1000},
          o.smooth_passes);
    visit_fields(o.resample, visit);
    visit(Field{"max_children", "Nodes with more children are split; 0 = never", Unit::none, 0, 1000},
          o.max_children);
}

/// What `prepare` changed, counted.
struct PrepareReport {
    std::uint32_t merged_branches = 0;  ///< branch nodes that became part of another one
    std::uint32_t smoothed_radii = 0;   ///< radii that changed
    ResampleReport resample;            ///< of the nodes between branch nodes
    std::uint32_t split_nodes = 0;      ///< nodes added to share the children of crowded ones
};

/// A skeleton ready for meshing, and what was done to it.
struct PrepareResult {
    Skeleton skeleton;               ///< the new one
    PrepareReport report;            ///< what was done
    std::vector<NodeId> new_of_old;  ///< for every node of the input the one that stands for it
};

/// Merges close branch nodes, smooths radii, resamples chains, splits crowded nodes, in this order:
/// resampling sees the final branch nodes and radii, and what splitting adds is not taken away again. Roots
/// and tips are never lost. Throws InvalidInput when max_children is 1 or negative. O(n log n).
PrepareResult prepare(const Skeleton& skeleton, const PrepareOptions& options = {});

}  // namespace coppice
