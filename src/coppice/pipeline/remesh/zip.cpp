#include "coppice/pipeline/remesh/zip_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coppice {
namespace {

// Returns the angles of a loop's vertices around an axis, continued beyond a full turn; one more than
// vertices.
std::vector<float> angles(const Loop& loop, std::span<const Vec3> positions, const LoopAxis& axis) {
    const Vec3 x = perpendicular(axis.direction), y = cross(axis.direction, x);
    std::vector<float> out;
    out.reserve(loop.size() + 1);
    for (std::size_t k = 0; k <= loop.size(); ++k) {
        const Vec3 p = positions[loop[k % loop.size()]] - axis.center;
        const float angle = std::atan2(dot(p, y), dot(p, x));
        out.push_back(out.empty()
                          ? angle
                          : out.back() + std::remainder(angle - out.back(), 2 * std::numbers::pi_v<float>));
    }
    return out;
}

int turns(std::span<const float> angle) {
    return static_cast<int>(std::lround((angle.back() - angle.front()) / (2 * std::numbers::pi_v<float>)));
}

// Returns the loop with another first vertex.
Loop started_at(const Loop& loop, std::size_t first) {
    Loop out = loop;
    std::rotate(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
    return out;
}

std::size_t nearest(const Loop& loop, std::span<const Vec3> positions, Vec3 p) {
    const auto farther = [&](std::uint32_t a, std::uint32_t b) {
        return distance(positions[a], p) < distance(positions[b], p);
    };
    return static_cast<std::size_t>(std::min_element(loop.begin(), loop.end(), farther) - loop.begin());
}

}  // namespace

int winding(const Loop& loop, std::span<const Vec3> positions, const LoopAxis& axis) {
    return turns(angles(loop, positions, axis));
}

std::optional<std::vector<Triangle>> zip(const Loop& outer, const Loop& inner,
                                         std::span<const Vec3> positions, const LoopAxis& axis) {
    const Loop near = started_at(inner, nearest(inner, positions, positions[outer[0]]));
    const std::vector<float> a = angles(outer, positions, axis), b = angles(near, positions, axis);
    const int sense = turns(a);
    if (std::abs(sense) != 1 || turns(b) != sense) return {};
    // Angle by which the inner loop begins slightly before or after the outer one.
    const float shift = a[0] + std::remainder(b[0] - a[0], 2 * std::numbers::pi_v<float>) - b[0];
    const auto way = [&](const std::vector<float>& angle, std::size_t k, float by) {
        return static_cast<float>(sense) * (angle[k] + angle[k + 1] + 2 * by);
    };
    std::vector<Triangle> band;
    band.reserve(outer.size() + near.size());
    for (std::size_t i = 0, j = 0; i < outer.size() || j < near.size();) {
        const std::uint32_t o = outer[i % outer.size()], n = near[j % near.size()];
        if (j == near.size() || (i < outer.size() && way(a, i, 0) <= way(b, j, shift))) {
            band.push_back({o, outer[++i % outer.size()], n});
        } else {
            band.push_back({near[++j % near.size()], n, o});
        }
    }
    return band;
}

}  // namespace coppice
