#include "coppice/tetra/lattice/pattern.h"

#include <algorithm>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

using Weights = std::array<std::uint8_t, 4>;
using Local = TetraPattern::Local;

/// The corners of every group, as bits.
constexpr std::array<std::uint32_t, TetraPattern::kGroups> kGroupCorners{1,  2,  4,  8,  3,  5, 9, 6,
                                                                         10, 12, 14, 13, 11, 7, 15};

std::uint32_t find_group(std::uint32_t corners) {
    return static_cast<std::uint32_t>(std::ranges::find(kGroupCorners, corners) - kGroupCorners.begin());
}

std::uint32_t find_corners(const Weights& w) {
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < 4; ++i) bits |= (w[i] > 0 ? 1u : 0u) << i;
    return bits;
}

/// Returns a key that orders weights lexicographically: elements of one group keep their order for any
/// assignment of the group's corners to corners of a tetrahedron. The last weight follows from the others.
std::uint32_t to_code(const Weights& w) {
    return std::uint32_t{w[0]} << 12 | std::uint32_t{w[1]} << 6 | w[2];
}

class PatternMaker {
  public:
    PatternMaker(int levels, std::uint32_t diagonal) : n_(1 << levels) {
        const auto& d = kTetraDiagonals[diagonal];
        path_ = {d[0], d[2], d[1], d[3]};
    }

    TetraPattern make() {
        list_vertices();
        list_tetra();
        list_edges();
        list_around();
        return std::move(out_);
    }

  private:
    void list_vertices() {
        for (int a = 0; a <= n_; ++a) {
            for (int b = 0; a + b <= n_; ++b) {
                for (int c = 0; a + b + c <= n_; ++c) {
                    const int d = n_ - a - b - c;
                    out_.weights.push_back({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                                            static_cast<std::uint8_t>(c), static_cast<std::uint8_t>(d)});
                }
            }
        }
        const auto key = [](const Weights& w) { return std::pair(find_group(find_corners(w)), to_code(w)); };
        std::ranges::sort(out_.weights, {}, key);
        std::vector<std::uint32_t> groups;
        for (const Weights& w : out_.weights) {
            groups.push_back(find_group(find_corners(w)));
            auto& share = out_.shares.emplace_back();
            std::ranges::transform(w, share.begin(), [&](std::uint8_t i) {
                return static_cast<float>(i) / static_cast<float>(n_);
            });
        }
        out_.group.assign(groups.begin(), groups.end());
        out_.first_vertex = starts(groups);
        by_code_.assign(std::size_t{1} << 18, 0);
        for (std::size_t v = 0; v < out_.weights.size(); ++v)
            by_code_[to_code(out_.weights[v])] = static_cast<Local>(v);
    }

    static std::array<std::uint32_t, TetraPattern::kGroups + 1> starts(
        const std::vector<std::uint32_t>& groups) {
        std::array<std::uint32_t, TetraPattern::kGroups + 1> first{};
        for (const std::uint32_t g : groups) ++first[g + 1];
        for (std::size_t g = 0; g < TetraPattern::kGroups; ++g) first[g + 1] += first[g];
        return first;
    }

    /// Point x >= y >= z along the path of edges through the four corners.
    bool in_tetra(std::array<int, 3> p) const {
        return p[0] <= n_ && p[1] <= p[0] && p[2] <= p[1] && p[2] >= 0;
    }
    Local vertex_at(std::array<int, 3> p) const {
        Weights w{};
        w[path_[0]] = static_cast<std::uint8_t>(n_ - p[0]);
        w[path_[1]] = static_cast<std::uint8_t>(p[0] - p[1]);
        w[path_[2]] = static_cast<std::uint8_t>(p[1] - p[2]);
        w[path_[3]] = static_cast<std::uint8_t>(p[2]);
        return by_code_[to_code(w)];
    }

    void list_tetra() {
        for (int x = 0; x < n_; ++x) {
            for (int y = 0; y <= x; ++y) {
                for (int z = 0; z <= y; ++z) cut_cube({x, y, z});
            }
        }
        if (out_.weights.size() > 64) return;
        for (const auto& t : out_.tetra) {
            std::uint64_t mask = 0;
            for (const Local v : t) mask |= std::uint64_t{1} << v;
            out_.tetra_masks.push_back(mask);
        }
    }

    /// Adds the six tetrahedra around the diagonal of a cube, one for every order of the axes, if they are
    /// inside.
    void cut_cube(std::array<int, 3> corner) {
        std::array<std::size_t, 3> axes{0, 1, 2};
        do {
            std::array<int, 3> p = corner;
            std::array<Local, 4> tetra{};
            bool inside = in_tetra(p);
            if (inside) tetra[0] = vertex_at(p);
            for (std::size_t i = 0; inside && i < 3; ++i) {
                ++p[axes[i]];
                inside = in_tetra(p);
                if (inside) tetra[i + 1] = vertex_at(p);
            }
            if (!inside) continue;
            if (is_odd(axes) != is_odd_path()) std::swap(tetra[2], tetra[3]);
            out_.tetra.push_back(tetra);
        } while (std::ranges::next_permutation(axes).found);
    }

    static bool is_odd(const std::array<std::size_t, 3>& axes) {
        return ((axes[0] > axes[1]) != (axes[0] > axes[2])) != (axes[1] > axes[2]);
    }
    bool is_odd_path() const {
        bool odd = false;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) odd ^= path_[i] > path_[j];
        }
        return odd;
    }

    struct Edge {
        std::uint32_t group;
        std::uint32_t low, high;  ///< codes of its ends, ascending
        friend auto operator<=>(const Edge&, const Edge&) = default;
    };
    Edge edge_between(Local a, Local b) const {
        const Weights &u = out_.weights[a], &v = out_.weights[b];
        const std::uint32_t c = to_code(u), d = to_code(v);
        return {find_group(find_corners(u) | find_corners(v)), std::min(c, d), std::max(c, d)};
    }

    void list_edges() {
        std::vector<Edge> edges;
        for (const auto& t : out_.tetra) {
            for (const auto& e : kTetraEdges) edges.push_back(edge_between(t[e[0]], t[e[1]]));
        }
        sort_unique(edges);
        std::vector<std::uint32_t> groups;
        for (const Edge& e : edges) {
            groups.push_back(e.group);
            out_.edges.push_back({by_code_[e.low], by_code_[e.high]});
        }
        out_.edge_group.assign(groups.begin(), groups.end());
        out_.first_edge = starts(groups);
        for (const auto& t : out_.tetra) {
            auto& of_tetra = out_.tetra_edges.emplace_back();
            for (std::size_t e = 0; e < 6; ++e) {
                const Edge edge = edge_between(t[kTetraEdges[e][0]], t[kTetraEdges[e][1]]);
                of_tetra[e] = static_cast<Local>(std::ranges::lower_bound(edges, edge) - edges.begin());
            }
        }
    }

    void list_around() {
        out_.first_around.assign(out_.weights.size() + 1, 0);
        for (const auto& t : out_.tetra) {
            for (const Local v : t) ++out_.first_around[v + 1u];
        }
        for (std::size_t v = 0; v < out_.weights.size(); ++v)
            out_.first_around[v + 1] += out_.first_around[v];
        std::vector<std::uint32_t> next(out_.first_around.begin(), out_.first_around.end() - 1);
        out_.around.resize(4 * out_.tetra.size());
        for (std::size_t t = 0; t < out_.tetra.size(); ++t) {
            for (const Local v : out_.tetra[t]) out_.around[next[v]++] = static_cast<Local>(t);
        }
    }

    int n_;
    std::array<std::uint8_t, 4>
        path_;  ///< the diagonal connects the midpoints of 0, 2 and of 1, 3 of this path
    std::vector<Local> by_code_;
    TetraPattern out_;
};

}  // namespace

TetraPattern tetra_pattern(int levels, std::uint32_t diagonal) {
    COPPICE_ASSERT(levels >= 0 && levels <= TetraPattern::kMaxLevels && diagonal < kTetraDiagonals.size());
    return PatternMaker(levels, diagonal).make();
}

}  // namespace coppice
