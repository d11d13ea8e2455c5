#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "coppice/base/column.h"

namespace coppice {

/// A partition of 0 .. count - 1 into sets that can be joined (union-find with path halving). The minimum
/// member represents its set, so that the result does not depend on the order of the joins. O(log n)
/// amortised.
class DisjointSets {
  public:
    /// Creates sets of one member.
    explicit DisjointSets(std::size_t count = 0) { reset(count); }

    /// Resets all numbers to sets of one member. Keeps the memory.
    void reset(std::size_t count) {
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    /// Returns the minimum member of the set of i.
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// Joins two sets; returns false if they are one set already.
    bool join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) return false;
        parent_[std::max(a, b)] = std::min(a, b);
        return true;
    }

  private:
    std::vector<std::uint32_t> parent_;
};

/// The same for concurrent joins by several threads.
class ConcurrentDisjointSets {
  public:
    /// Creates sets of one member.
    explicit ConcurrentDisjointSets(std::uint32_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    /// Joins two sets; lock-free.
    void join(std::uint32_t a, std::uint32_t b) {
        for (;;) {
            a = find(a);
            b = find(b);
            if (a == b) return;
            if (a < b) std::swap(a, b);
            std::uint32_t expected = a;
            if (std::atomic_ref(parent_[a]).compare_exchange_strong(expected, b, std::memory_order_relaxed))
                return;
        }
    }
    /// Returns the number of sets; must not run concurrently with joins.
    std::uint64_t set_count() const {
        std::uint64_t sets = 0;
        for (std::uint32_t i = 0; i < parent_.size(); ++i) sets += parent_[i] == i;
        return sets;
    }

    /// Returns the minimum member of the set of i; during concurrent joins some member.
    std::uint32_t find(std::uint32_t i) {
        for (;;) {
            const std::uint32_t parent = std::atomic_ref(parent_[i]).load(std::memory_order_relaxed);
            if (parent == i) return i;
            std::uint32_t expected = parent;
            const std::uint32_t grandparent =
                std::atomic_ref(parent_[parent]).load(std::memory_order_relaxed);
            std::atomic_ref(parent_[i])
                .compare_exchange_weak(expected, grandparent, std::memory_order_relaxed);
            i = grandparent;
        }
    }

  private:
    Buffer<std::uint32_t> parent_;
};

}  // namespace coppice
