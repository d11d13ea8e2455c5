#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"

namespace coppice {

/// Numbers of which one is drawn in proportion to its weight, while weights change: the inverse of the
/// cumulative distribution, kept as sums of eights of sums. Sums are made anew from what lies below them, so
/// nothing drifts. Building is O(n), a draw and a change O(log n).
class SumPyramid {
  public:
    SumPyramid() = default;  ///< nothing to draw from
    /// Weights are finite and not negative.
    SumPyramid(Buffer<double> weights, const Context& ctx);

    std::uint32_t size() const { return size_; }                       ///< number of weights
    double total() const { return total_; }                            ///< of all weights
    double operator[](std::uint32_t i) const { return level_[0][i]; }  ///< the weight of one

    /// The item at which the cumulative sum passes share * total, share in [0, 1): never one of weight 0. The
    /// total must be above 0.
    std::uint32_t find(double share) const;

    /// Writes a weight; the sums above hold again after `update` has been told of it.
    void set(std::uint32_t i, double weight) { level_[0][i] = weight; }
    /// Makes the sums above the given items anew; the span is used as scratch. Neighbours cost little.
    void update(std::span<std::uint32_t> changed);

  private:
    static constexpr std::uint32_t kWidth = 8;
    static double sum_of(const double* eight);

    std::vector<Buffer<double>> level_;  ///< each a multiple of kWidth long; the last has one group
    std::uint32_t size_ = 0;
    double total_ = 0;
};

}  // namespace coppice
