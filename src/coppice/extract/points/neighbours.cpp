#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/neighbours_internal.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kNeighboursGrain = 4096;

/// Returns the dimension of the points around one from the distances to its neighbours, by maximum
/// likelihood [Levina2004]; 2 if there are too few.
double local_dimension(std::span<const float> distances) {
    constexpr double kSurface = 2;
    double sum = 0;
    std::size_t count = 0;
    for (const float d : distances) {
        if (d <= 0) continue;
        sum += std::log(double{distances.back()} / double{d});
        ++count;
    }
    // The last neighbour adds nothing, and one more is the correction for the bias.
    if (count < 3 || sum <= 0) return kSurface;
    return std::clamp(static_cast<double>(count - 2) / sum, 1.0, kSurface);
}

/// Writes the row of point i without the point itself.
void find_row(const KdTree& tree, Vec3 point, std::size_t i, std::vector<std::uint32_t>& index,
              std::vector<double>& squared, Neighbours& out) {
    tree.nearest(point, index, squared);
    std::size_t to = i * out.count;
    const std::size_t end = to + out.count;
    for (std::size_t k = 0; k <= out.count && to < end; ++k) {
        if (index[k] == i) continue;
        out.index[to] = index[k];
        out.distance[to++] = static_cast<float>(std::sqrt(squared[k]));
    }
}

}  // namespace

Neighbours nearest_neighbours(std::span<const Vec3> points, std::uint32_t count, const Context& ctx) {
    Neighbours out;
    out.count = static_cast<std::uint32_t>(std::min<std::size_t>(count, points.size() - 1));
    out.index.resize(points.size() * out.count);
    out.distance.resize(points.size() * out.count);
    const KdTree tree(points, ctx);
    parallel_for_ranges(ctx, points.size(), kNeighboursGrain, [&](IndexRange range) {
        std::vector<std::uint32_t> index(out.count + 1);
        std::vector<double> squared(out.count + 1);
        for (std::size_t i = range.begin; i < range.end; ++i) {
            find_row(tree, points[i], i, index, squared, out);
        }
    });
    return out;
}

Buffer<float> local_spacing(const Neighbours& neighbours, std::uint32_t rank) {
    const std::size_t n = neighbours.count == 0 ? 0 : neighbours.index.size() / neighbours.count;
    Buffer<float> spacing(n);
    const std::uint32_t last = std::min(rank, neighbours.count) - 1;
    for (std::size_t i = 0; i < n; ++i) spacing[i] = neighbours.distances(i)[last];
    return spacing;
}

Buffer<float> local_step(const Neighbours& neighbours, std::uint32_t rank) {
    Buffer<float> step = local_spacing(neighbours, rank);
    for (std::size_t i = 0; i < step.size(); ++i) {
        const double d = local_dimension(neighbours.distances(i));
        step[i] *= static_cast<float>(std::min(1.0, std::pow(2 * d / rank, 1 / d)));
    }
    return step;
}

}  // namespace coppice::extract_internal
