#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/pipeline/coarsen/node_levels_internal.h"
#include "coppice/pipeline/coarsen/selection_internal.h"
#include "coppice/pipeline/surface_field_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::uint32_t kTransitionQuads = 6;  // for every four sides of the finer ring

// Returns the end or branch node of a cage quad that is not a side.
NodeId find_node(const TubeRows& tube_rows, std::uint32_t f) {
    const ControlMesh& control = tube_rows.cage();
    const NodeId region(control.region[f]);
    if (control.part[f] == TubeFace::start) return tube_rows.tubes().parent(region);
    return control.part[f] == TubeFace::end ? tube_rows.end_node(region) : region;
}

// Returns the number of quads of a tube between rings.
std::uint64_t count_quads(std::uint32_t sides, std::span<const TubeRing> rings) {
    std::uint64_t out = 0;
    for (std::size_t i = 1; i < rings.size(); ++i) {
        const int fine = std::max(rings[i - 1].level, rings[i].level);
        const std::uint64_t around = std::uint64_t{sides} << fine;
        out += rings[i - 1].level == rings[i].level ? around : around / 4 * kTransitionQuads;
    }
    return out;
}

class Selector {
  public:
    Selector(const RefinedGrid& grid, std::span<const std::uint8_t> node_level)
        : grid_(grid), tube_rows_(grid.tube_rows()), control_(tube_rows_.cage()), level_(node_level) {}

    Selection run() {
        out_.growth.assign(grid_.vertex_count(), 0.0f);
        for (std::uint32_t f = 0; f < control_.part.size(); ++f) {
            if (control_.part[f] != TubeFace::side) {
                add_patch(f);
            } else if (const NodeId tube(control_.region[f]); grid_.faces(tube).side.first == f) {
                add_tube(tube, grid_.faces(tube).side);
            }
        }
        return std::move(out_);
    }

  private:
    int level(NodeId n) const { return level_[n.index()]; }

    void add_quad(const Quad& q, std::uint32_t cage_quad) {
        out_.made.quads.push_back(q);
        out_.made.cage_quad.push_back(cage_quad);
    }

    double polygon_radius(int level) const { return corner_radius(std::ldexp(tube_rows_.sides(), level)); }

    // Returns the relative outward displacement of a vertex for polygons of this level to keep the area of
    // the previous ones.
    float growth(int level) const {
        return static_cast<float>(polygon_radius(level) / polygon_radius(tube_rows_.levels()) - 1);
    }

    // Chords across crotches compensate for about half of the missing area of polygons at branch nodes.
    float growth_at_fork(NodeId n) const { return 0.5f * growth(level(n)); }

    void add_patch(std::uint32_t f) {
        if (!grid_.has_patch(f)) return;
        const NodeId node = find_node(tube_rows_, f);
        const int l = level(node);
        const std::uint32_t n = grid_.size(), step = n >> l;
        const auto at = [&](std::uint32_t i, std::uint32_t j) { return grid_.vertex(f, i, j); };
        for (std::uint32_t j = 0; j < n; j += step) {
            for (std::uint32_t i = 0; i < n; i += step)
                add_quad({at(i, j), at(i + step, j), at(i + step, j + step), at(i, j + step)}, f);
        }
        if (control_.part[f] != TubeFace::fork) return;  // caps do not move, except for their rim
        for (std::uint32_t j = 0; j <= n; j += step) {
            for (std::uint32_t i = 0; i <= n; i += step) out_.growth[at(i, j)] = growth_at_fork(node);
        }
    }

    void add_tube(NodeId tube, const CageRun& side) {
        if (!grid_.is_whole(tube)) {
            add_what_stays(side, tube);
            return;
        }
        const std::vector<TubeRing> rings = list_rings(side, tube);
        for (std::size_t i = 0; i < rings.size(); ++i) {
            const bool is_end = i == 0 || i + 1 == rings.size();
            const NodeId node = tube_rows_.node(tube, i == 0 ? 0 : 1);
            const bool is_at_fork = is_end && tube_rows_.is_fork(node);
            set_growth(side, rings[i], is_at_fork ? growth_at_fork(node) : growth(rings[i].level));
        }
        for (std::size_t i = 1; i < rings.size(); ++i) {
            if (rings[i - 1].level == rings[i].level) {
                add_row(side, rings[i - 1].row, rings[i]);
            } else if (rings[i - 1].level > rings[i].level) {
                add_transition(side, rings[i - 1], rings[i], false);
            } else {
                add_transition(side, rings[i], rings[i - 1], true);
            }
        }
    }

    void set_growth(const CageRun& side, const TubeRing& ring, float growth) {
        for (std::uint32_t c = 0; c < grid_.columns(side); c += grid_.size() >> ring.level)
            out_.growth[grid_.vertex(side, c, ring.row)] = growth;
    }

    void add_what_stays(const CageRun& side, NodeId tube) {
        for (std::uint32_t row = 0; row < grid_.size(); ++row) {
            if (grid_.stays(tube_rows_.first(tube) + row)) add_row(side, row, {row + 1, tube_rows_.levels()});
        }
    }

    // Returns the minimum number of rings that stay near the refined ones.
    std::vector<TubeRing> list_rings(const CageRun& side, NodeId tube) const {
        const int begin = level(tube_rows_.node(tube, 0)), end = level(tube_rows_.node(tube, 1));
        const int most = max_rows(begin, end, tube_rows_.levels());
        for (int rows = std::min(begin, end);; ++rows) {
            std::vector<TubeRing> rings = rings_between(begin, end, rows, tube_rows_.levels());
            if (rows == most || are_near(side, rings)) return rings;
        }
    }

    bool are_near(const CageRun& side, std::span<const TubeRing> rings) const {
        for (std::size_t i = 1; i < rings.size(); ++i) {
            if (!is_near(side, rings[i - 1], rings[i])) return false;
        }
        return true;
    }

    // Returns whether refined vertices between two rings are as close to the lines between these as the
    // middle of a side of the ring is to its circle.
    bool is_near(const CageRun& side, const TubeRing& a, const TubeRing& b) const {
        const int l = std::min(a.level, b.level);
        const double limit = sagitta(std::ldexp(tube_rows_.sides(), l));
        for (std::uint32_t c = 0; c < grid_.columns(side); c += grid_.size() >> l) {
            const auto at = [&](std::uint32_t row) { return grid_.position(grid_.vertex(side, c, row)); };
            const Vec3 from = at(a.row), axis = at(b.row) - from;
            for (std::uint32_t row = a.row + 1; row < b.row; ++row) {
                const Vec3 p = at(row), anchor = grid_.anchor(grid_.vertex(side, c, row));
                const float t = closest_parameter(p, from, axis, 1.0f);
                if (distance(p, from + axis * t) > limit * distance(p, anchor)) return false;
            }
        }
        return true;
    }

    // Adds the quads between two rings of one level.
    void add_row(const CageRun& side, std::uint32_t row, const TubeRing& next) {
        const std::uint32_t step = grid_.size() >> next.level;
        for (std::uint32_t c = 0; c < grid_.columns(side); c += step) {
            add_quad({grid_.vertex(side, c, row), grid_.vertex(side, c + step, row),
                      grid_.vertex(side, c + step, next.row), grid_.vertex(side, c, next.row)},
                     side.first + c / grid_.size());
        }
    }

    // Adds the quads between a ring and one of half as many sides: six for every four sides of the finer one.
    void add_transition(const CageRun& side, const TubeRing& fine, const TubeRing& coarse, bool is_reversed) {
        const std::uint32_t step = grid_.size() >> fine.level, middle = (fine.row + coarse.row) / 2;
        const float between = (growth(fine.level) + growth(coarse.level)) / 2;
        for (std::uint32_t c = 0; c < grid_.columns(side); c += 4 * step) {
            const auto a = [&](std::uint32_t k) { return grid_.vertex(side, c + k * step, fine.row); };
            const auto m = [&](std::uint32_t k) { return grid_.vertex(side, c + k * step, middle); };
            const auto b = [&](std::uint32_t k) { return grid_.vertex(side, c + k * step, coarse.row); };
            for (const std::uint32_t k : {1u, 2u, 3u}) out_.growth[m(k)] = between;
            const std::array<Quad, kTransitionQuads> quads{{{a(0), a(1), m(1), b(0)},
                                                            {a(1), a(2), m(2), m(1)},
                                                            {a(2), a(3), m(3), m(2)},
                                                            {a(3), a(4), b(4), m(3)},
                                                            {b(0), m(1), m(2), b(2)},
                                                            {b(2), m(2), m(3), b(4)}}};
            for (Quad q : quads) {
                if (is_reversed) std::ranges::reverse(q);
                add_quad(q, side.first + c / grid_.size());
            }
        }
    }

    const RefinedGrid& grid_;
    const TubeRows& tube_rows_;
    const ControlMesh& control_;
    std::span<const std::uint8_t> level_;
    Selection out_;
};

}  // namespace

Selection select_quads(const RefinedGrid& grid, std::span<const std::uint8_t> node_level) {
    return Selector(grid, node_level).run();
}

std::uint64_t faces_by_radius(const ControlMesh& control, const Skeleton& tubes, int levels,
                              float chord_error) {
    const TubeRows tube_rows(control, tubes, levels);
    const std::vector<std::uint8_t> level = node_levels_by_radius(tube_rows, chord_error);
    std::uint64_t out = 0;
    for (std::uint32_t f = 0; f < control.part.size(); ++f) {
        if (control.part[f] != TubeFace::side)
            out += std::uint64_t{1} << (2 * level[find_node(tube_rows, f).index()]);
    }
    const std::vector<TubeFaces> faces = faces_of_tubes(tube_rows);
    for (const NodeId tube : nodes(tubes)) {
        const std::uint32_t sides = faces[tube.index()].side.count;
        if (sides == 0) continue;
        const int begin = level[tube_rows.node(tube, 0).index()],
                  end = level[tube_rows.node(tube, 1).index()];
        out += count_quads(sides, rings_between(begin, end, std::min(begin, end), levels));
    }
    return out;
}

}  // namespace coppice::pipeline_internal
