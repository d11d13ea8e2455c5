#include "coppice/points/sampling/sum_pyramid_internal.h"

#include <utility>

#include "coppice/base/parallel.h"

namespace coppice {

double SumPyramid::compute_sum(const double* w) {
    return ((w[0] + w[1]) + (w[2] + w[3])) + ((w[4] + w[5]) + (w[6] + w[7]));
}

SumPyramid::SumPyramid(Buffer<double> weights, const Context& ctx)
    : size_(static_cast<std::uint32_t>(weights.size())) {
    const auto pad = [](Buffer<double>& level) {
        while (level.size() % kWidth != 0 || level.empty()) level.push_back(0);
    };
    pad(weights);
    level_.push_back(std::move(weights));
    while (level_.back().size() > kWidth) {
        const Buffer<double>& below = level_.back();
        Buffer<double> sums(below.size() / kWidth);
        parallel_for(ctx, sums.size(), std::size_t{1} << 14,
                     [&](std::size_t i) { sums[i] = compute_sum(&below[i * kWidth]); });
        pad(sums);
        level_.push_back(std::move(sums));
    }
    total_ = compute_sum(level_.back().data());
}

std::uint32_t SumPyramid::find(double share) const {
    COPPICE_ASSERT(total_ > 0);
    double rest = share * total_;
    std::uint32_t group = 0;
    for (std::size_t l = level_.size(); l-- > 0;) {
        const double* const w = &level_[l][std::size_t{group} * kWidth];
        // Rounding may move `rest` past the end: use the last item above 0.
        std::uint32_t chosen = kWidth;
        for (std::uint32_t k = 0; k < kWidth; ++k) {
            if (!(w[k] > 0)) continue;
            chosen = k;
            if (rest < w[k]) break;
            rest -= w[k];
        }
        group = group * kWidth + chosen;
    }
    return group;
}

void SumPyramid::update(std::span<std::uint32_t> changed) {
    std::size_t count = changed.size();
    for (std::size_t l = 0; l + 1 < level_.size(); ++l) {
        std::size_t groups = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t group = changed[i] / kWidth;
            if (groups > 0 && changed[groups - 1] == group) continue;
            level_[l + 1][group] = compute_sum(&level_[l][std::size_t{group} * kWidth]);
            changed[groups++] = group;
        }
        count = groups;
    }
    total_ = compute_sum(level_.back().data());
}

}  // namespace coppice
