#include "coppice/extract/prior/isotonic_internal.h"

#include <utility>

#include "coppice/base/id.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {
namespace {

/// Blocks of nodes that share a value, each identified by its node closest to the root, with a heap of its
/// child blocks, largest mean first. The heaps are skew heaps, which meld in O(log n) on average.
class Blocks {
  public:
    explicit Blocks(std::size_t count)
        : sum_(count),
          weight_(count),
          left_(count, kNoIndex),
          right_(count, kNoIndex),
          below_(count, kNoIndex) {}

    void make(std::uint32_t n, double value, double weight) {
        sum_[n] = value * weight;
        weight_[n] = weight;
    }
    double mean(std::uint32_t n) const { return sum_[n] / weight_[n]; }
    std::uint32_t max_below(std::uint32_t n) const { return below_[n]; }
    void hang(std::uint32_t n, std::uint32_t on) { below_[on] = meld(below_[on], n); }

    /// Merges the largest child block of n into it.
    void absorb_greatest(std::uint32_t n) {
        const std::uint32_t c = below_[n];
        sum_[n] += sum_[c];
        weight_[n] += weight_[c];
        below_[n] = meld(meld(left_[c], right_[c]), below_[c]);
    }

  private:
    bool before(std::uint32_t a, std::uint32_t b) const {
        const double x = mean(a), y = mean(b);
        return x > y || (x == y && a < b);
    }
    std::uint32_t meld(std::uint32_t a, std::uint32_t b) {
        std::uint32_t top = kNoIndex;
        std::uint32_t* link = &top;
        while (a != kNoIndex && b != kNoIndex) {
            if (before(b, a)) std::swap(a, b);
            *link = a;
            link = &left_[a];
            const std::uint32_t rest = std::exchange(right_[a], left_[a]);
            a = rest;
        }
        *link = a != kNoIndex ? a : b;
        return top;
    }

    std::vector<double> sum_, weight_;
    std::vector<std::uint32_t> left_, right_;  ///< children of each block in the heap that contains it
    std::vector<std::uint32_t> below_;         ///< top of its own heap
};

}  // namespace

std::vector<double> isotonic_on_tree(std::span<const std::uint32_t> parent, std::span<const double> value,
                                     std::span<const double> weight) {
    const auto size = static_cast<std::uint32_t>(parent.size());
    Blocks blocks(size);
    std::vector<std::uint32_t> absorbed_by(size, kNoIndex);
    for (std::uint32_t n = 0; n < size; ++n) blocks.make(n, value[n], weight[n]);
    for (std::uint32_t n = size; n-- > 0;) {
        for (std::uint32_t c = blocks.max_below(n); c != kNoIndex && blocks.mean(c) > blocks.mean(n);
             c = blocks.max_below(n)) {
            blocks.absorb_greatest(n);
            absorbed_by[c] = n;
        }
        if (parent[n] != kNoIndex) blocks.hang(n, parent[n]);
    }
    std::vector<double> out(size);
    for (std::uint32_t n = 0; n < size; ++n)
        out[n] = absorbed_by[n] == kNoIndex ? blocks.mean(n) : out[absorbed_by[n]];
    return out;
}

}  // namespace coppice::extract_internal
