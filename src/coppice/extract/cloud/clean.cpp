#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "coppice/base/box.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/extract/cloud/clean_internal.h"
#include "coppice/extract/stage_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kGrain = 16384;
constexpr double kCells = 2097151;  // 2^21 - 1 along each axis, so that three numbers fit 63 bits

Box3 bounds_of(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return box;
}

/// Puts two zeros between the lowest 21 bits.
std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

double widest(const Box3& box) {
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    return std::max({size.x, size.y, size.z});
}

bool before(Vec3 a, Vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

}  // namespace

Buffer<CubePlace> by_cube(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Box3 box = bounds_of(points);
    edge = std::max(edge, widest(box) / kCells);
    Buffer<CubePlace> place(points.size());
    stoppable_for(ctx, points.size(), kGrain, [&](std::size_t i) {
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double at = (double{points[i][axis]} - double{box.low[axis]}) / edge;
            key |= spread(static_cast<std::uint64_t>(std::clamp(at, 0.0, kCells))) << axis;
        }
        place[i] = {key, static_cast<std::uint32_t>(i)};
    });
    radix_sort(ctx, place, 63, [](const CubePlace& p) { return p.key; });
    return place;
}

Buffer<Vec3> sorted_without_duplicates(std::span<const Vec3> points, const Context& ctx) {
    const Buffer<CubePlace> place = by_cube(points, 1e-30, ctx);
    Buffer<Vec3> sorted;
    sorted.reserve(points.size());
    for (std::size_t first = 0, turn = 0; first < place.size();) {
        poll_stop(ctx, turn++);
        std::size_t last = first;
        const std::size_t start = sorted.size();
        for (; last < place.size() && place[last].key == place[first].key; ++last) {
            sorted.push_back(points[place[last].index]);
        }
        const auto begin = sorted.begin() + static_cast<std::ptrdiff_t>(start);
        std::sort(begin, sorted.end(), before);
        sorted.erase(std::unique(begin, sorted.end()), sorted.end());
        first = last;
    }
    return sorted;
}

Buffer<Vec3> thinned(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Buffer<CubePlace> place = by_cube(points, edge, ctx);
    Buffer<Vec3> kept;
    for (std::size_t first = 0, turn = 0; first < place.size();) {
        poll_stop(ctx, turn++);
        std::size_t last = first;
        Vec3d sum;
        for (; last < place.size() && place[last].key == place[first].key; ++last) {
            sum += Vec3d(points[place[last].index]);
        }
        kept.push_back(Vec3(sum / static_cast<double>(last - first)));
        first = last;
    }
    return kept;
}

Buffer<Vec3> thinned_to(Buffer<Vec3> points, std::size_t limit, const Context& ctx) {
    if (points.size() <= limit) return points;
    Buffer<Vec3> kept;
    // Points lie on surfaces, of which cubes of the widest extent / sqrt(limit) leave about `limit`.
    double edge = widest(bounds_of(points)) / std::sqrt(static_cast<double>(limit)) / 4;
    for (bool enough = false; !enough; edge *= 1.25) {
        kept = thinned(points, edge, ctx);
        enough = kept.size() <= limit;
    }
    return kept;
}

Buffer<float> local_spacing(const Neighbours& neighbours, std::uint32_t rank) {
    const std::size_t n = neighbours.count == 0 ? 0 : neighbours.index.size() / neighbours.count;
    Buffer<float> spacing(n);
    const std::uint32_t last = std::min(rank, neighbours.count) - 1;
    for (std::size_t i = 0; i < n; ++i) spacing[i] = neighbours.distances(i)[last];
    return spacing;
}

std::vector<std::uint8_t> strays(const Neighbours& neighbours, double factor, const Context& ctx) {
    constexpr std::uint32_t kNear = 6;
    const std::uint32_t near = std::min(kNear, neighbours.count);
    const std::size_t n = neighbours.index.size() / neighbours.count;
    Buffer<float> mean(n);
    stoppable_for(ctx, n, kGrain, [&](std::size_t i) {
        double sum = 0;
        for (std::uint32_t k = 0; k < near; ++k) sum += neighbours.distances(i)[k];
        mean[i] = static_cast<float>(sum / near);
    });
    std::vector<std::uint8_t> stray(n, 0);
    stoppable_for(ctx, n, kGrain, [&](std::size_t i) {
        std::array<float, kNear> about{};
        for (std::uint32_t k = 0; k < near; ++k) about[k] = mean[neighbours.of(i)[k]];
        std::nth_element(about.begin(), about.begin() + near / 2, about.begin() + near);
        stray[i] = mean[i] > factor * about[near / 2];
    });
    return stray;
}

float median(std::span<const float> values) {
    Buffer<float> sorted(values.begin(), values.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
}

}  // namespace coppice::extract_internal
