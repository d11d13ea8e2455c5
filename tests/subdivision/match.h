#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns for every point of a the closest point of b within `tolerance`; the size of b if there is none.
inline std::vector<std::uint32_t> match_points(std::span<const Vec3> a, std::span<const Vec3> b,
                                               float tolerance) {
    std::vector<std::uint32_t> by_x(b.size());
    std::iota(by_x.begin(), by_x.end(), 0u);
    std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t i, std::uint32_t j) { return b[i].x < b[j].x; });
    std::vector<std::uint32_t> match(a.size(), static_cast<std::uint32_t>(b.size()));
    for (std::size_t i = 0; i < a.size(); ++i) {
        float best = tolerance;
        auto it = std::lower_bound(by_x.begin(), by_x.end(), a[i].x - tolerance,
                                   [&](std::uint32_t j, float x) { return b[j].x < x; });
        for (; it != by_x.end() && b[*it].x <= a[i].x + tolerance; ++it) {
            const float d = distance(a[i], b[*it]);
            if (d > best) continue;
            best = d;
            match[i] = *it;
        }
    }
    return match;
}

/// Returns quads renamed by `map` (identity if empty), each beginning with its lowest corner, sorted: equal
/// for equal oriented surfaces.
inline std::vector<Quad> canonical_quads(std::span<const Quad> quads,
                                         std::span<const std::uint32_t> map = {}) {
    std::vector<Quad> out(quads.begin(), quads.end());
    for (Quad& q : out) {
        if (!map.empty()) {
            for (std::uint32_t& v : q) v = map[v];
        }
        std::rotate(q.begin(), std::min_element(q.begin(), q.end()), q.end());
    }
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace coppice
