#include "coppice/io_skeleton/rsml/attach_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "coppice/base/id.h"

namespace coppice::rsml {

namespace {

constexpr std::uint32_t kPointsPerLeaf = 4;

/// Returns the parameter of the closest point of a segment to p.
double nearest_parameter(Vec3d a, Vec3d b, Vec3d p) {
    const Vec3d along = b - a;
    const double length_squared = dot(along, along);
    const double t = length_squared > 0 ? dot(p - a, along) / length_squared : 0;
    return t > 0 ? std::min(t, 1.0) : 0;  // 0 if t is not a number
}

/// Returns the index of the parent's point that a root specifies, counted from `base`; nullopt if it
/// specifies none.
std::optional<std::uint32_t> named_point(const Root& root, const Root& parent, double base) {
    const double index = root.parent_node - base;
    if (!(index >= 0) || index >= parent.point_count || index != std::floor(index)) return std::nullopt;
    return static_cast<std::uint32_t>(index);
}

Vec3d get_point(const Document& document, const Root& root, std::uint32_t index) {
    return document.points[root.first_point + index];
}

/// Returns whether the points of parents are counted from 0 or 1: the base for which they are closer to the
/// starts of roots.
double base_of_parent_nodes(const Document& document, std::span<const std::uint32_t> parent) {
    std::array<double, 2> total{};
    for (std::size_t i = 0; i < parent.size(); ++i) {
        if (parent[i] == kNoIndex) continue;
        const Root &root = document.roots[i], &bearer = document.roots[parent[i]];
        const auto zero = named_point(root, bearer, 0), one = named_point(root, bearer, 1);
        if (!zero || !one) continue;
        const Vec3d start = get_point(document, root, 0);
        total[0] += distance(start, get_point(document, bearer, *zero));
        total[1] += distance(start, get_point(document, bearer, *one));
    }
    return total[1] < total[0] ? 1 : 0;
}

}  // namespace

double NearestOnLine::Box::distance_squared(Vec3d p) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double off = std::max({low[axis] - p[axis], p[axis] - high[axis], 0.0});
        sum += off * off;
    }
    return sum;
}

NearestOnLine::NearestOnLine(std::span<const Vec3d> line) : line_(line) {
    while (leaves_ * kPointsPerLeaf < line.size()) leaves_ *= 2;
    const double infinity = std::numeric_limits<double>::infinity();
    const Vec3d none{infinity, infinity, infinity};
    boxes_.assign(2 * static_cast<std::size_t>(leaves_), {none, -none});
    const auto grow = [](Box& box, Vec3d low, Vec3d high) {
        box.low = {std::min(box.low.x, low.x), std::min(box.low.y, low.y), std::min(box.low.z, low.z)};
        box.high = {std::max(box.high.x, high.x), std::max(box.high.y, high.y), std::max(box.high.z, high.z)};
    };
    for (std::uint32_t i = 0; i < line.size(); ++i) {
        Box& box = boxes_[leaves_ + i / kPointsPerLeaf];
        grow(box, line[i], line[i]);
        if (i + 1 < line.size()) grow(box, line[i + 1], line[i + 1]);
    }
    for (std::uint32_t i = leaves_ - 1; i > 0; --i) {
        grow(boxes_[i], boxes_[2 * i].low, boxes_[2 * i].high);
        grow(boxes_[i], boxes_[2 * i + 1].low, boxes_[2 * i + 1].high);
    }
}

LinePlace NearestOnLine::operator()(Vec3d p) const {
    constexpr int kMaxSteps = 1024;
    LinePlace best;
    double best_squared = std::numeric_limits<double>::infinity();
    std::vector<std::uint32_t> open{1};
    for (int step = 0; step < kMaxSteps && !open.empty(); ++step) {
        const std::uint32_t box = open.back();
        open.pop_back();
        if (!(boxes_[box].distance_squared(p) < best_squared)) continue;
        if (box < leaves_) {
            const std::uint32_t left = 2 * box;
            const bool right_first = boxes_[left + 1].distance_squared(p) < boxes_[left].distance_squared(p);
            open.push_back(right_first ? left : left + 1);
            open.push_back(right_first ? left + 1 : left);
            continue;
        }
        const auto size = static_cast<std::uint32_t>(line_.size());
        const std::uint32_t first = (box - leaves_) * kPointsPerLeaf;
        for (std::uint32_t i = first; i < std::min(first + kPointsPerLeaf, size); ++i) {
            const Vec3d a = line_[i], b = line_[std::min(i + 1, size - 1)];
            const double t = nearest_parameter(a, b, p);
            const Vec3d off = p - (a + t * (b - a));
            if (dot(off, off) < best_squared) {
                best_squared = dot(off, off);
                best = t < 1 ? LinePlace{i, t} : LinePlace{i + 1, 0};
            }
        }
    }
    return best;
}

std::vector<LinePlace> attach_roots(const Document& document, std::span<const std::uint32_t> parent) {
    const double base = base_of_parent_nodes(document, parent);
    std::vector<LinePlace> places(document.roots.size());
    std::vector<std::optional<NearestOnLine>> lines(document.roots.size());
    for (std::size_t i = 0; i < parent.size(); ++i) {
        const Root& root = document.roots[i];
        if (parent[i] == kNoIndex || root.point_count == 0) continue;
        const Root& bearer = document.roots[parent[i]];
        if (const auto point = named_point(root, bearer, base)) {
            places[i].point = *point;
            continue;
        }
        auto& line = lines[parent[i]];
        if (!line) line.emplace(std::span(document.points).subspan(bearer.first_point, bearer.point_count));
        places[i] = (*line)(document.points[root.first_point]);
    }
    return places;
}

}  // namespace coppice::rsml
