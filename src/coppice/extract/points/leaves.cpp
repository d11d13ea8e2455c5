#include "coppice/extract/points/leaves_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/box.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/normal_dispersion_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kLeavesGrain = 4096;
// [height] maximum spacing of a scale; at coarser scales crowns of twigs look like leaves
constexpr double kCoarsest = 0.025;
constexpr double kWidest = 0.1;       // [m] maximum spacing of a scale
constexpr double kLeafyShare = 0.25;  // minimum share of points of high dispersion in a cloud with leaves
constexpr double kLeafyMean = 0.175;  // minimum mean dispersion above the threshold in a cloud with leaves
constexpr double kSmoothMean = 0.09;  // maximum mean dispersion below the threshold; larger values are noise
constexpr std::size_t kMinPlaces = 100;  // minimum number of points of a scale
constexpr int kSmoothPasses = 2;         // smoothing passes of the dispersion
constexpr double kBeyond = 10;           // [spacing] minimum length of wood, or of the path beyond it
constexpr float kSlender = 35;           // [radius] maximum length that a branch supports
constexpr int kReachPasses = 24;         // each pass covers about two spacings

/// Cloud at one resolution; at the finest scale the points themselves, by reference.
struct Scale {
    std::span<const Vec3> points;
    const Neighbours* point_rows;
    VoxelGrid voxels;
    Neighbours rows;
    NormalDispersion dispersion;
    bool coarse = false;

    std::span<const Vec3> at() const { return coarse ? std::span<const Vec3>(voxels.centroid) : points; }
    const Neighbours& near() const { return coarse ? rows : *point_rows; }
    std::uint32_t of(std::size_t i) const {
        return coarse ? voxels.of_point[i] : static_cast<std::uint32_t>(i);
    }
    bool leafy() const { return dispersion.share >= kLeafyShare && dispersion.high_mean >= kLeafyMean; }
};

Scale finest_scale(std::span<const Vec3> points, const Neighbours& near, const Context& ctx) {
    return {points, &near, {}, {}, normal_dispersion(points, near, ctx)};
}

/// Returns nullopt if the voxels have no effect, or if too few points are left.
std::optional<Scale> coarser_scale(const Scale& fine, double edge, const Context& ctx) {
    Scale scale{fine.points, fine.point_rows, voxel_grid(fine.points, edge, ctx), {}, {}, true};
    if (scale.voxels.centroid.size() < kMinPlaces) return {};
    scale.rows = nearest_neighbours(scale.voxels.centroid, kDispersionNeighbours, ctx);
    scale.dispersion = normal_dispersion(scale.voxels.centroid, scale.rows, ctx);
    if (!(scale.dispersion.spacing > fine.dispersion.spacing)) return {};
    return scale;
}

/// Returns the finest scale with leaves, and true; otherwise the coarsest one, and false.
std::pair<Scale, bool> find_scale(std::span<const Vec3> points, const Neighbours& near, const Context& ctx) {
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    const double coarsest = std::min(kWidest, kCoarsest * (double{box.high.z} - double{box.low.z}));
    Scale here = finest_scale(points, near, ctx);
    for (double edge = 2 * here.dispersion.spacing; here.dispersion.spacing <= coarsest; edge *= 2) {
        std::optional<Scale> next = coarser_scale(here, edge, ctx);
        if (!next) break;
        // Noise also increases the dispersion of wood, but not at the next scale.
        if (here.leafy() && next->leafy() && here.dispersion.low_mean <= kSmoothMean)
            return {std::move(here), true};
        if (next->dispersion.spacing > coarsest) break;
        here = std::move(*next);
    }
    return {std::move(here), false};
}

/// Returns the dispersion at the points, averaged over neighbours.
Buffer<float> smoothed(const Scale& scale, const Context& ctx) {
    const Neighbours& near = *scale.point_rows;
    const std::uint32_t count = std::min(kDispersionNeighbours, near.count);
    Buffer<float> value(scale.points.size()), scratch(scale.points.size());
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = scale.dispersion.value[scale.of(i)];
    for (int pass = 0; pass < kSmoothPasses; ++pass) {
        parallel_for(ctx, value.size(), kLeavesGrain, [&](std::size_t i) {
            float sum = value[i];
            for (const std::uint32_t j : near.of(i).first(count)) sum += value[j];
            scratch[i] = sum / static_cast<float>(count + 1);
        });
        value.swap(scratch);
    }
    return value;
}

/// Marks the voxels in which all points are marked.
std::vector<std::uint8_t> marked_voxels(const Scale& scale, std::span<const std::uint8_t> marked) {
    std::vector<std::uint8_t> all(scale.at().size(), 1);
    for (std::size_t i = 0; i < marked.size(); ++i) all[scale.of(i)] &= marked[i];
    return all;
}

/// Returns how far the shortest paths from the roots continue beyond every point [m].
Buffer<float> length_beyond(const Scale& scale, std::span<const std::uint8_t> ignored,
                            const LeafOptions& options, const Context& ctx) {
    const auto at = scale.at();
    const ConnectedGraph joined = connect_points(at, scale.near(), ignored, options.gap, ctx);
    const Graph near = make_graph(scale.near(), ignored, joined.bridges, ctx, options.gap.usual);
    std::vector<std::uint32_t> sources;
    for (const auto& base :
         find_roots(at, near, joined.components, {scale.dispersion.spacing, options.root}, ctx)) {
        sources.insert(sources.end(), base.begin(), base.end());
    }
    // Uses one spacing for all: leaves are at least as dense as wood.
    const Buffer<float> spacing(at.size(), static_cast<float>(scale.dispersion.spacing));
    const std::vector<std::uint32_t> free(at.size(), kNoIndex);
    const Paths paths = shortest_paths(joined.graph, sources, free, {spacing}, ctx);
    Buffer<float> beyond(at.size(), 0);
    for (std::size_t k = paths.order.size(); k-- > 0;) {
        const std::uint32_t p = paths.order[k], q = paths.parent[p];
        if (q == kNoIndex) continue;
        beyond[q] = std::max(beyond[q], beyond[p] + length(at[p] - at[q]));
    }
    return beyond;
}

/// Returns the distance [m] around every point within which there may be wood that supports the path beyond,
/// negative without wood: paths follow the surface of a branch, and the rest of the branch is within its
/// thickness.
Buffer<float> wood_reach(const Buffer<float>& beyond, const Neighbours& near, double least,
                         const Context& ctx) {
    Buffer<float> reach(beyond.size()), scratch(beyond.size());
    for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = beyond[i] > least ? beyond[i] / kSlender : -1;
    for (int pass = 0; pass < kReachPasses; ++pass) {
        parallel_for(ctx, reach.size(), kLeavesGrain, [&](std::size_t i) {
            float most = reach[i];
            for (std::uint32_t k = 0; k < near.count; ++k)
                most = std::max(most, reach[near.of(i)[k]] - near.distances(i)[k]);
            scratch[i] = most;
        });
        reach.swap(scratch);
    }
    return reach;
}

/// Assigns components of wood shorter than `least` [m] to the leaves. `out` marks leaves and ignored points.
void drop_small_wood(std::vector<std::uint8_t>& leaf, const Scale& scale, std::span<const std::uint8_t> out,
                     double least, const Context& ctx) {
    const Components parts = components(scale.near(), marked_voxels(scale, out), {}, ctx);
    std::vector<Box3> box(parts.size.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!out[i]) box[parts.of[scale.of(i)]].extend(scale.points[i]);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!out[i] && box[parts.of[scale.of(i)]].diagonal() < least) leaf[i] = 1;
    }
}

}  // namespace

std::vector<std::uint8_t> find_leaves(std::span<const Vec3> points, const Neighbours& near,
                                      std::span<const std::uint8_t> ignored, const LeafOptions& options,
                                      const Context& ctx) {
    // A different number of neighbours would change all thresholds.
    if (near.count < kDispersionNeighbours && near.count + 1 < points.size()) {
        return find_leaves(points, nearest_neighbours(points, kDispersionNeighbours, ctx), ignored, options,
                           ctx);
    }
    std::vector<std::uint8_t> leaf(points.size(), 0);
    const auto [scale, leafy] = find_scale(points, near, ctx);
    if (!leafy && !options.always) return leaf;
    const double least = kBeyond * scale.dispersion.spacing;
    const Buffer<float> wood = wood_reach(length_beyond(scale, marked_voxels(scale, ignored), options, ctx),
                                          scale.near(), least, ctx);
    const Buffer<float> value = smoothed(scale, ctx);
    std::vector<std::uint8_t> out(ignored.begin(), ignored.end());
    for (std::size_t i = 0; i < points.size(); ++i) {
        leaf[i] = !ignored[i] && value[i] > scale.dispersion.threshold && wood[scale.of(i)] < 0;
        out[i] |= leaf[i];
    }
    drop_small_wood(leaf, scale, out, least, ctx);
    return leaf;
}

}  // namespace coppice::extract_internal
