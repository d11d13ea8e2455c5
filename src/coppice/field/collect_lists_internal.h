#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/field/candidate_lists.h"

namespace coppice {

/// Concatenates lists found in parallel, `grain` regions at a time: find(range, put) calls put(region,
/// segment) for the regions of its range in order.
template <class Find>
CandidateLists collect_lists(std::size_t regions, std::size_t grain, const Context& ctx, const Find& find) {
    std::vector<std::vector<std::uint32_t>> parts((regions + grain - 1) / grain);
    CandidateLists lists;
    lists.first.assign(regions + 1, 0);
    parallel_for_ranges(ctx, regions, grain, [&](IndexRange range) {
        std::vector<std::uint32_t>& part = parts[range.begin / grain];
        part.reserve(8 * range.size());
        find(range, [&](std::size_t region, std::uint32_t segment) {
            part.push_back(segment);
            ++lists.first[region];
        });
    });
    lists.segments.resize(exclusive_scan(std::span(lists.first)));
    parallel_for(ctx, parts.size(), 1, [&](std::size_t i) {
        std::copy(parts[i].begin(), parts[i].end(),
                  lists.segments.begin() + static_cast<std::ptrdiff_t>(lists.first[i * grain]));
    });
    return lists;
}

}  // namespace coppice
