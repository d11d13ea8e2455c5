#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"

namespace coppice {

/// Draws from items in proportion to their weights, which may change: the inverse of the cumulative
/// distribution, stored as a tree of sums of eight. Sums are recomputed from the level below, so that errors
/// do not accumulate. Construction is O(n), a draw and a change O(log n).
class SumPyramid {
  public:
    SumPyramid() = default;  ///< no items
    /// Weights are finite and not negative.
    SumPyramid(Buffer<double> weights, const Context& ctx);

    std::uint32_t size() const { return size_; }                       ///< number of weights
    double total() const { return total_; }                            ///< sum of all weights
    double operator[](std::uint32_t i) const { return level_[0][i]; }  ///< weight of item i

    /// Returns the item at which the cumulative sum exceeds share * total, share in [0, 1): never one of
    /// weight 0. The total must be above 0.
    std::uint32_t find(double share) const;

    /// Stores a weight; the sums are valid again after a call of `update` with this item.
    void set(std::uint32_t i, double weight) { level_[0][i] = weight; }
    /// Recomputes the sums above the given items; the span is used as temporary memory. Neighbouring items
    /// share costs.
    void update(std::span<std::uint32_t> changed);

  private:
    static constexpr std::uint32_t kWidth = 8;
    static double compute_sum(const double* eight);

    std::vector<Buffer<double>> level_;  ///< the size of each is a multiple of kWidth; the last has one group
    std::uint32_t size_ = 0;
    double total_ = 0;
};

}  // namespace coppice
