#include "coppice/skeleton/prepare.h"

#include <utility>

#include "coppice/base/check_fields.h"
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

}  // namespace coppice
