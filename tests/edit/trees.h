#pragma once

#include <initializer_list>
#include <vector>

#include "coppice/edit/editable_tree.h"
#include "coppice/edit/selection.h"

namespace coppice::test {

/// A stem 0 1 2 3 of 1 m segments along the z axis, and a branch 4 5 6 from node 1 along x, with laterals 7
/// (of 5, along y) and 8 (of 2, along -x).
inline Skeleton stem_with_branches() {
    const auto id = [](std::uint32_t i) { return NodeId(i); };
    const NodeId none;
    return Skeleton(
        {none, id(0), id(1), id(2), id(1), id(4), id(5), id(5), id(2)},
        {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}, {2, 1, 1}, {-1, 0, 2}},
        {0.1f, 0.1f, 0.08f, 0.06f, 0.05f, 0.04f, 0.03f, 0.02f, 0.02f});
}

inline NodeSet ids(std::initializer_list<std::uint32_t> numbers) {
    NodeSet out;
    for (const std::uint32_t n : numbers) out.emplace_back(n);
    return out;
}

inline StableId id(std::uint32_t n) { return StableId(n); }

/// Returns whether two skeletons are bit-identical, including ids.
inline bool same(const Skeleton& a, const Skeleton& b) {
    if (a.size() != b.size()) return false;
    for (const NodeId n : nodes(a)) {
        if (a.parent(n) != b.parent(n) || a.position(n) != b.position(n) || a.radius(n) != b.radius(n) ||
            a.stable_id(n) != b.stable_id(n))
            return false;
    }
    return a.origin() == b.origin();
}

inline bool near(Vec3 a, Vec3 b) { return distance(a, b) < 1e-5f; }

}  // namespace coppice::test
