#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/pipeline/coarsen/node_levels_internal.h"

namespace coppice::pipeline_internal {
namespace {

class NodeLevels {
  public:
    NodeLevels(const RefinedGrid& grid, float chord_error)
        : grid_(grid), tube_rows_(grid.tube_rows()), out_(node_levels_by_radius(tube_rows_, chord_error)) {}

    std::vector<std::uint8_t> run() {
        keep_remeshed();
        const ControlMesh& control = tube_rows_.cage();
        for (const NodeId tube : nodes(tube_rows_.tubes())) {
            const CageRun& side = grid_.faces(tube).side;
            if (side.count > 0 && grid_.is_whole(tube)) set_by_shape(tube, side);
        }
        for (std::uint32_t f = 0; f < control.part.size(); ++f) {
            if (control.part[f] == TubeFace::fork) set_by_shape(NodeId(control.region[f]), f);
        }
        return std::move(out_);
    }

  private:
    int levels() const { return tube_rows_.levels(); }

    void raise(NodeId n, int level) {
        out_[n.index()] = std::max(out_[n.index()], static_cast<std::uint8_t>(level));
    }

    void keep_remeshed() {
        for (const NodeId tube : nodes(tube_rows_.tubes())) {
            if (grid_.is_whole(tube)) continue;
            raise(tube_rows_.end_node(tube), levels());
            if (!tube_rows_.tubes().is_root(tube)) raise(tube_rows_.tubes().parent(tube), levels());
        }
    }

    // Sets levels from the sections of a tube, each end from those of the closer half.
    void set_by_shape(NodeId tube, const CageRun& side) {
        const Segment s = tube_rows_.tubes().segment(tube);
        const std::uint32_t n = grid_.size();
        for (std::uint32_t row = 0; row <= n; ++row) {
            const auto at = [&](std::uint32_t c) { return grid_.position(grid_.vertex(side, c, row)); };
            const auto t = static_cast<float>(row) / static_cast<float>(n);
            const float radius = s.radius_a + t * (s.radius_b - s.radius_a);
            const int level = level_for(grid_.columns(side), at, radius);
            if (2 * row <= n) raise(tube_rows_.node(tube, 0), level);
            if (2 * row >= n) raise(tube_rows_.node(tube, 1), level);
        }
    }

    // Sets levels from the lines of a cage quad at a branch node, along and across.
    void set_by_shape(NodeId node, std::uint32_t f) {
        if (!grid_.has_patch(f)) return;
        const std::uint32_t n = grid_.size();
        const float radius = tube_rows_.tubes().radius(node);
        for (std::uint32_t line = 0; line <= n; ++line) {
            const auto along = [&](std::uint32_t i) { return grid_.position(grid_.vertex(f, i, line)); };
            const auto across = [&](std::uint32_t i) { return grid_.position(grid_.vertex(f, line, i)); };
            raise(node, std::max(level_for(n, along, radius), level_for(n, across, radius)));
        }
    }

    // Returns the minimum level at which refined vertices 0 .. count of a line are near the chords between
    // the kept ones.
    template <class At>
    int level_for(std::uint32_t count, const At& at, float radius) const {
        constexpr double kMaxDeviation = 3;  // multiple of the deviation of a circle
        int level = 0;
        for (; level < levels(); ++level) {
            const std::uint32_t step = grid_.size() >> level;
            const double sides = std::ldexp(tube_rows_.sides(), level);
            const auto limit = static_cast<float>(kMaxDeviation * sagitta(sides) * double{radius});
            if (are_near(count, step, at, limit)) break;
        }
        return level;
    }

    template <class At>
    static bool are_near(std::uint32_t count, std::uint32_t step, const At& at, float limit) {
        for (std::uint32_t c = 0; c < count; c += step) {
            const Vec3 from = at(c), chord = at(c + step) - from;
            for (std::uint32_t i = 1; i < step; ++i) {
                const Vec3 p = at(c + i);
                const float t = closest_parameter(p, from, chord, 1.0f);
                if (distance(p, from + chord * t) > limit) return false;
            }
        }
        return true;
    }

    const RefinedGrid& grid_;
    const TubeRows& tube_rows_;
    std::vector<std::uint8_t> out_;
};

}  // namespace

double sagitta(double sides) { return 1 - std::cos(std::numbers::pi / sides); }

float thickest_radius(const Skeleton& tubes) {
    float largest = 0;
    for (const NodeId n : nodes(tubes)) {
        if (!tubes.is_root(n) || tubes.children(n).size() <= 1) largest = std::max(largest, tubes.radius(n));
    }
    return largest;
}

int level_for_chord(float radius, std::uint32_t sides, float chord_error) {
    const double wanted = std::numbers::pi * std::sqrt(double{radius} / (2 * double{chord_error}));
    return static_cast<int>(std::lround(std::clamp(std::log2(wanted / sides), 0.0, 30.0)));
}

float chord_error_at(float radius, std::uint32_t sides, int level) {
    const double half_angle = std::numbers::pi / std::ldexp(sides, level);
    return static_cast<float>(double{radius} * half_angle * half_angle / 2);
}

std::vector<std::uint8_t> node_levels_by_radius(const TubeRows& tube_rows, float chord_error) {
    const Skeleton& tubes = tube_rows.tubes();
    if (chord_error == 0)
        chord_error = chord_error_at(thickest_radius(tubes), tube_rows.sides(), tube_rows.levels());
    std::vector<std::uint8_t> out(tubes.size(), 0);
    const auto raise = [&](NodeId n, float radius) {
        const int level =
            std::min(level_for_chord(radius, tube_rows.sides(), chord_error), tube_rows.levels());
        out[n.index()] = std::max(out[n.index()], static_cast<std::uint8_t>(level));
    };
    for (const NodeId n : nodes(tubes)) {
        if (tubes.is_root(n)) {
            raise(n, tubes.radius(n));
            continue;
        }
        const Segment s = tubes.segment(n);
        raise(tubes.parent(n), s.radius_a);
        raise(tube_rows.end_node(n), s.radius_b);
    }
    return out;
}

std::vector<std::uint8_t> node_levels(const RefinedGrid& grid, float chord_error) {
    return NodeLevels(grid, chord_error).run();
}

int max_rows(int begin, int end, int levels) {
    const int steps = std::abs(begin - end);
    int rows = levels;
    while ((1 << (levels - rows)) < 2 * steps && rows > std::min(begin, end)) --rows;
    return rows;
}

std::vector<TubeRing> rings_between(int begin, int end, int rows, int levels) {
    const int coarse = std::min(begin, end), steps = std::max(begin, end) - coarse;
    const std::uint32_t count = 1u << levels, row = count >> rows;
    std::vector<TubeRing> out;
    for (int i = 0; i < steps; ++i) {
        const auto at = std::lround(static_cast<double>(row) * i / steps);
        out.push_back({static_cast<std::uint32_t>(at), coarse + steps - i});
    }
    for (std::uint32_t at = steps > 0 ? row : 0; at <= count; at += row) out.push_back({at, coarse});
    if (begin >= end) return out;
    std::ranges::reverse(out);
    for (TubeRing& ring : out) ring.row = count - ring.row;
    return out;
}

}  // namespace coppice::pipeline_internal
