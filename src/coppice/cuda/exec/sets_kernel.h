#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics.h"

namespace coppice::cuda {

/// A partition of numbers into sets that threads join side by side; see ConcurrentDisjointSets. The least
/// member stands for its set, so that nothing depends on the order of the joins.
struct DeviceSets {
    std::span<std::uint32_t> parent;  ///< at first, that of each number is itself

    /// The member that stands for the set of a number, or some lesser one while others join.
    COPPICE_HOST_DEVICE std::uint32_t find(std::uint32_t i) const {
        // What was read may be out of date, but then leads to the same member on a longer way.
        for (std::uint32_t next = peek(parent[i]); next != i; next = peek(parent[i])) i = next;
        return i;
    }
    /// Makes two sets one.
    COPPICE_HOST_DEVICE void join(std::uint32_t a, std::uint32_t b) const {
        a = find_and_shorten(a);
        b = find_and_shorten(b);
        while (a != b) {
            if (a < b) {
                const std::uint32_t greater = b;
                b = a;
                a = greater;
            }
            const std::uint32_t seen = replace(parent[a], a, b);
            if (seen == a) return;
            a = find(seen);
            b = find(b);
        }
    }

  private:
    /// The same as find(); every number on the way leads twice as far from now on.
    COPPICE_HOST_DEVICE std::uint32_t find_and_shorten(std::uint32_t i) const {
        for (std::uint32_t next = peek(parent[i]); next != i;) {
            const std::uint32_t after = peek(parent[next]);
            if (after != next) replace(parent[i], next, after);
            i = next;
            next = after;
        }
        return i;
    }
};

/// Every number is a set of its own.
struct BeginSets {
    DeviceSets sets;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { sets.parent[i] = i; }
};

/// Shortens the ways: what has to be looked at by many.
struct FlattenSets {
    DeviceSets sets;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        // Others look on meanwhile, and find the same member by either way.
        const std::uint32_t root = sets.find(i), parent = peek(sets.parent[i]);
        if (root != parent) replace(sets.parent[i], parent, root);
    }
};

}  // namespace coppice::cuda
