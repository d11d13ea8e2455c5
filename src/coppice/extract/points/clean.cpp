#include "coppice/extract/points/clean_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "coppice/base/box.h"
#include "coppice/base/kernel/morton.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/sort.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kCleanGrain = 16384;

Box3 compute_bounds(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    return box;
}

double widest(const Box3& box) {
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    return std::max({size.x, size.y, size.z});
}

}  // namespace

bool comes_before(Vec3 a, Vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

Buffer<MortonPlace> morton_order(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Box3 box = compute_bounds(points);
    constexpr double kLast = kMortonCells - 1;
    edge = std::max(edge, widest(box) / kLast);
    Buffer<MortonPlace> place(points.size());
    parallel_for(ctx, points.size(), kCleanGrain, [&](std::size_t i) {
        const auto cell = [&](int axis) {
            const double at = (double{points[i][axis]} - double{box.low[axis]}) / edge;
            return static_cast<std::uint64_t>(std::clamp(at, 0.0, kLast));
        };
        place[i] = {morton_code(cell(0), cell(1), cell(2)), static_cast<std::uint32_t>(i)};
    });
    radix_sort(ctx, place, 63, [](const MortonPlace& p) { return p.key; });
    return place;
}

Buffer<Vec3> sorted_without_duplicates(std::span<const Vec3> points, const Context& ctx) {
    const Buffer<MortonPlace> place = morton_order(points, 1e-30, ctx);
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
        std::sort(begin, sorted.end(), comes_before);
        sorted.erase(std::unique(begin, sorted.end()), sorted.end());
        first = last;
    }
    return sorted;
}

Buffer<Vec3> voxel_downsample(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Buffer<MortonPlace> place = morton_order(points, edge, ctx);
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

Buffer<Vec3> downsample_to(Buffer<Vec3> points, std::size_t limit, const Context& ctx) {
    if (points.size() <= limit) return points;
    Buffer<Vec3> kept;
    // Points are on surfaces: voxels of the maximum extent / sqrt(limit) leave about `limit` of them.
    double edge = widest(compute_bounds(points)) / std::sqrt(static_cast<double>(limit)) / 4;
    for (bool enough = false; !enough; edge *= 1.25) {
        kept = voxel_downsample(points, edge, ctx);
        enough = kept.size() <= limit;
    }
    return kept;
}

std::vector<std::uint8_t> find_outliers(const Neighbours& neighbours, double factor, const Context& ctx) {
    constexpr std::uint32_t kNear = 6;
    const std::uint32_t near = std::min(kNear, neighbours.count);
    const std::size_t n = neighbours.index.size() / neighbours.count;
    Buffer<float> mean(n);
    parallel_for(ctx, n, kCleanGrain, [&](std::size_t i) {
        double sum = 0;
        for (std::uint32_t k = 0; k < near; ++k) sum += neighbours.distances(i)[k];
        mean[i] = static_cast<float>(sum / near);
    });
    std::vector<std::uint8_t> outlier(n, 0);
    parallel_for(ctx, n, kCleanGrain, [&](std::size_t i) {
        std::array<float, kNear> about{};
        for (std::uint32_t k = 0; k < near; ++k) about[k] = mean[neighbours.of(i)[k]];
        outlier[i] = mean[i] > factor * median_in_place(std::span(about).first(near));
    });
    return outlier;
}

}  // namespace coppice::extract_internal
