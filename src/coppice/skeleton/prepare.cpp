#include "coppice/skeleton/prepare.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/skeleton/chains_internal.h"
#include "coppice/skeleton/edit_internal.h"

namespace coppice {
namespace {

/// Applies the result of a step; `Result` has skeleton and new_of_old.
template <class Result>
void take_over(PrepareResult& to, Result&& step) {
    for (NodeId& n : to.new_of_old) n = step.new_of_old[n.index()];
    to.skeleton = std::move(step.skeleton);
}

}  // namespace

PrepareResult prepare(const Skeleton& skeleton, const PrepareOptions& options) {
    check_fields(options, "prepare");
    if (skeleton.size() == 0) throw InvalidInput("the skeleton has no nodes");
    PrepareResult result{skeleton, {}, all_nodes(skeleton)};
    if (options.merge_branches > 0) {
        EditResult merged = merge_close_branches(result.skeleton, options.merge_branches);
        result.report.merged_branches = merged.count;
        take_over(result, std::move(merged));
    }
    if (options.smooth_passes > 0) {
        EditResult smooth = smooth_radii(result.skeleton, options.smooth_passes);
        result.report.smoothed_radii = smooth.count;
        take_over(result, std::move(smooth));
    }
    if (options.resample.method != ResampleMethod::none) {
        ResampleResult resampled = resample(result.skeleton, options.resample);
        result.report.resample = resampled.report;
        take_over(result, std::move(resampled));
    }
    if (options.max_children != 0) {
        EditResult split = split_crowded_nodes(result.skeleton, options.max_children);
        result.report.split_nodes = split.count;
        take_over(result, std::move(split));
    }
    return result;
}

void list_fields(PrepareOptions& o, FieldList& list) {
    list.add(Field{"merge_branches", "Distance below which two branch nodes are merged; 0 disables merging.",
                   Unit::radius, 0, 2},
             o.merge_branches);
    list.add(
        Field{"smooth_passes", "Number of passes that average radii along branches.", Unit::none, 0, 1000},
        o.smooth_passes);
    list_fields(o.resample, list);
    list.add(Field{"max_children",
                   "Maximum number of children, above which a node is split; 0 disables splitting.",
                   Unit::none, 0, 1000},
             o.max_children);
}

}  // namespace coppice
