#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/resample.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options for preparing a skeleton for meshing.
struct PrepareOptions {
    /// [radius] distance below which branch nodes are merged; 0: never; in [0, 2]
    float merge_branches = 0.5f;
    int smooth_passes = 0;     ///< number of passes that average radii along axes; in [0, 1000]
    ResampleOptions resample;  ///< resampling of the nodes between branch nodes
    /// maximum number of children, above which nodes are split; 0: never, otherwise in [2, 1000]
    int max_children = 0;
};

/// Lists the members for front ends.
void list_fields(PrepareOptions& o, FieldList& list);

/// Numbers of changes by `prepare`.
struct PrepareReport {
    std::uint32_t merged_branches = 0;  ///< branch nodes merged into another one
    std::uint32_t smoothed_radii = 0;   ///< changed radii
    ResampleReport resample;            ///< changes of the nodes between branch nodes
    std::uint32_t split_nodes = 0;      ///< nodes added to distribute the children of others
};

/// A skeleton prepared for meshing, with a report of the changes.
struct PrepareResult {
    Skeleton skeleton;               ///< prepared skeleton
    PrepareReport report;            ///< changes
    std::vector<NodeId> new_of_old;  ///< by input node: the new node that replaces it
};

/// Merges close branch nodes, smooths radii, resamples chains and splits nodes with many children, in this
/// order: resampling uses the final branch nodes and radii, and the nodes added by splitting are not removed
/// again. Roots and tips are preserved. Throws InvalidInput if max_children is 1 or negative, or if there
/// are no nodes. O(n log n).
PrepareResult prepare(const Skeleton& skeleton, const PrepareOptions& options = {});

}  // namespace coppice
