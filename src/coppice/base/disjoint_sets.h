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

/// A partition of 0 .. count - 1 into sets that can be joined (union-find, with path halving). The least
/// member stands for its set, so that the outcome does not depend on the order of the joins. O(log n)
/// amortised.
class DisjointSets {
  public:
    /// Sets of one.
    explicit DisjointSets(std::size_t count = 0) { reset(count); }

    /// Every number is a set of its own again. Keeps the memory.
    void reset(std::size_t count) {
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    /// The least member of the set that i is in.
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// False where both are in one set already.
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

/// The same for several threads that join at once.
class ConcurrentDisjointSets {
  public:
    /// Sets of one.
    explicit ConcurrentDisjointSets(std::uint32_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    /// Waits for nobody.
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
    /// The number of sets; not while others join.
    std::uint64_t set_count() const {
        std::uint64_t sets = 0;
        for (std::uint32_t i = 0; i < parent_.size(); ++i) sets += parent_[i] == i;
        return sets;
    }

    /// The least member of the set that i is in; of some member while others join.
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
