#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "coppice/tetra/march/samples_view.h"

namespace coppice::tetra_internal {

/// One bit per item, and the number of set bits before each word.
class RankedBits {
  public:
    explicit RankedBits(std::size_t count) : words_(count / 64 + 2) {}
    /// Copies these words, padded or truncated to the required number.
    RankedBits(std::size_t count, std::vector<std::uint64_t> words) : words_(std::move(words)) {
        words_.resize(count / 64 + 2);
    }

    std::span<const std::uint64_t> words() const { return words_; }
    std::span<std::uint64_t> words() { return words_; }
    bool test(std::size_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
    void set(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
    void reset(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

    /// Recomputes the ranks; returns the number of set bits.
    std::uint32_t count() {
        before_.resize(words_.size());
        std::uint32_t sum = 0;
        for (std::size_t w = 0; w < words_.size(); ++w) {
            before_[w] = sum;
            sum += tetra_kernel::count_bits(words_[w]);
        }
        return sum;
    }
    /// Returns the number of set bits before i at the last call of count().
    std::uint32_t rank(std::size_t i) const { return view().rank(i); }
    /// Returns spans, which are valid as long as this object.
    tetra_kernel::RankedView view() const { return {words_, before_}; }

  private:
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_;
};

/// Calls use(i) for every set bit, in order.
template <class Use>
void for_each_bit(std::span<const std::uint64_t> words, const Use& use) {
    for (std::size_t w = 0; w < words.size(); ++w) {
        for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
            use(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(rest)));
    }
}

}  // namespace coppice::tetra_internal
