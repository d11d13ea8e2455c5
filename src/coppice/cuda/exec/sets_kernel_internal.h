#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics_internal.h"

namespace coppice::cuda {

/// A partition of numbers into disjoint sets that threads join concurrently; see ConcurrentDisjointSets. The
/// smallest member represents its set, so that the result does not depend on the order of the joins.
struct DeviceSets {
    std::span<std::uint32_t> parent;  ///< initially the number itself

    /// Returns the representative of the set of a number, or a smaller member while other threads join sets.
    COPPICE_HOST_DEVICE std::uint32_t find(std::uint32_t i) const {
        // A value that was read may be outdated, but then leads to the same member on a longer path.
        for (std::uint32_t next = peek(parent[i]); next != i; next = peek(parent[i])) i = next;
        return i;
    }
    /// Joins two sets.
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
    /// Finds the representative and halves the path to it.
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

/// Makes every number a set of its own.
struct BeginSets {
    DeviceSets sets;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { sets.parent[i] = i; }
};

/// Shortens all paths, for sets that are queried often.
struct FlattenSets {
    DeviceSets sets;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        // Other threads read at the same time, and find the same member on either path.
        const std::uint32_t root = sets.find(i), parent = peek(sets.parent[i]);
        if (root != parent) replace(sets.parent[i], parent, root);
    }
};

}  // namespace coppice::cuda
