#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace coppice {

/// A set of numbers below some bound: a bit for each.
class NumberSet {
  public:
    /// Empty, for numbers below `bound`.
    explicit NumberSet(std::size_t bound) : word_((bound + 63) / 64, 0) {}

    /// Puts i in, which must be below the bound; false where it was in. O(1).
    bool add(std::uint32_t i) {
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        const bool is_new = (word_[i / 64] & bit) == 0;
        word_[i / 64] |= bit;
        return is_new;
    }

    /// Takes i out, which must be below the bound. O(1).
    void remove(std::uint32_t i) { word_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
    /// Whether i is in, which must be below the bound. O(1).
    bool contains(std::uint32_t i) const { return (word_[i / 64] >> (i % 64) & 1) != 0; }

    /// Lets rank() be asked, for what is in now. O(bound / 64).
    void count() {
        before_.resize(word_.size());
        std::uint32_t sum = 0;
        for (std::size_t w = 0; w < word_.size(); ++w) {
            before_[w] = sum;
            sum += static_cast<std::uint32_t>(std::popcount(word_[w]));
        }
    }
    /// How many members are less than i, which must be below the bound. O(1).
    std::uint32_t rank(std::uint32_t i) const {
        const std::uint64_t below = word_[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1);
        return before_[i / 64] + static_cast<std::uint32_t>(std::popcount(below));
    }

    /// All members. O(bound / 64 + members).
    std::vector<std::uint32_t> ascending() const {
        std::vector<std::uint32_t> out;
        for (std::size_t w = 0; w < word_.size(); ++w) {
            for (std::uint64_t bits = word_[w]; bits != 0; bits &= bits - 1)
                out.push_back(static_cast<std::uint32_t>(64 * w) +
                              static_cast<std::uint32_t>(std::countr_zero(bits)));
        }
        return out;
    }

  private:
    std::vector<std::uint64_t> word_;
    std::vector<std::uint32_t> before_;  // per word: members in earlier ones
};

/// Some of many numbers, and their places in ascending order.
class ChosenNumbers {
  public:
    /// The members of a set. O(bound / 64 + members).
    explicit ChosenNumbers(NumberSet set) : set_(std::move(set)), all_(set_.ascending()) { set_.count(); }

    /// Whether i was chosen, which must be below the bound of the set. O(1).
    bool has(std::uint32_t i) const { return set_.contains(i); }
    std::uint32_t place(std::uint32_t i) const { return set_.rank(i); }        ///< of i, which was chosen
    std::uint32_t operator[](std::size_t place) const { return all_[place]; }  ///< the number there
    std::size_t size() const { return all_.size(); }                           ///< how many were chosen
    auto begin() const { return all_.begin(); }                                ///< the least one
    auto end() const { return all_.end(); }                                    ///< beyond the greatest

  private:
    NumberSet set_;
    std::vector<std::uint32_t> all_;
};

}  // namespace coppice
