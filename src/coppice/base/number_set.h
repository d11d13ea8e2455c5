#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace coppice {

/// A set of numbers below a bound, with one bit for each.
class NumberSet {
  public:
    /// Creates an empty set for numbers below `bound`.
    explicit NumberSet(std::size_t bound) : word_((bound + 63) / 64, 0) {}

    /// Inserts i, which must be below the bound; returns false if the set contained it. O(1).
    bool add(std::uint32_t i) {
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        const bool is_new = (word_[i / 64] & bit) == 0;
        word_[i / 64] |= bit;
        return is_new;
    }

    /// Removes i, which must be below the bound. O(1).
    void remove(std::uint32_t i) { word_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
    /// Returns whether the set contains i, which must be below the bound. O(1).
    bool contains(std::uint32_t i) const { return (word_[i / 64] >> (i % 64) & 1) != 0; }

    /// Prepares rank() for the current members. O(bound / 64).
    void count() {
        before_.resize(word_.size());
        std::uint32_t sum = 0;
        for (std::size_t w = 0; w < word_.size(); ++w) {
            before_[w] = sum;
            sum += static_cast<std::uint32_t>(std::popcount(word_[w]));
        }
    }
    /// Returns the number of members less than i, which must be below the bound. O(1).
    std::uint32_t rank(std::uint32_t i) const {
        const std::uint64_t below = word_[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1);
        return before_[i / 64] + static_cast<std::uint32_t>(std::popcount(below));
    }

    /// Returns all members. O(bound / 64 + members).
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
    std::vector<std::uint32_t> before_;  // per word: number of members in earlier words
};

/// A selection of numbers, and their ranks in ascending order.
class ChosenNumbers {
  public:
    /// Selects the members of a set. O(bound / 64 + members).
    explicit ChosenNumbers(NumberSet set) : set_(std::move(set)), all_(set_.ascending()) { set_.count(); }

    /// Returns whether i is selected; i must be below the bound of the set. O(1).
    bool has(std::uint32_t i) const { return set_.contains(i); }
    std::uint32_t place(std::uint32_t i) const { return set_.rank(i); }        ///< rank of a selected number
    std::uint32_t operator[](std::size_t place) const { return all_[place]; }  ///< the number with that rank
    std::size_t size() const { return all_.size(); }                           ///< number of selected numbers
    auto begin() const { return all_.begin(); }                                ///< the first selected number
    auto end() const { return all_.end(); }  ///< past the last selected number

  private:
    NumberSet set_;
    std::vector<std::uint32_t> all_;
};

}  // namespace coppice
