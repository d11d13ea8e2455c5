#include <algorithm>
#include <cmath>
#include <cstddef>
#include <queue>
#include <utility>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/plot/segments_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::uint32_t kNeighbours = 10;
constexpr double kStemReach = 1.3;     // [radius] points so near to the axis of a stem are its own
constexpr double kFootReach = 3;       // [radius] within it nothing grows but the tree, besides kFootRoom
constexpr double kFootRoom = 0.3;      // [m]
constexpr double kFloor = 0.3;         // [m] above the ground, where understorey stands
constexpr double kUnderstorey = 0.02;  // [m] its thickness, in the place of a diameter at breast height
constexpr double kScaling = 2.0 / 3;   // exponent of the diameter that makes paths in trees alike
constexpr double kMeet = 1.1;          // of the sum of two radii: stems so near are one below
constexpr double kBreast = 1.3;        // [m]

/// The voxels that hold points, along the Morton curve, and the one of each point.
struct Voxels {
    Buffer<Vec3> centroid;
    Buffer<float> height;  ///< [m] above the ground, mean
    Buffer<std::uint32_t> of_point;
};

Voxels make_voxels(std::span<const Vec3> points, std::span<const float> height,
                   std::span<const std::uint32_t> used, double edge, const Context& ctx) {
    Buffer<Vec3> place(used.size());
    for (std::size_t i = 0; i < used.size(); ++i) place[i] = points[used[i]];
    const Buffer<MortonPlace> order = morton_order(place, edge, ctx);
    Voxels out;
    out.of_point.assign(points.size(), kNone);
    for (std::size_t first = 0, turn = 0; first < order.size();) {
        poll_stop(ctx, turn++);
        std::size_t last = first;
        Vec3d sum;
        double above = 0;
        for (; last < order.size() && order[last].key == order[first].key; ++last) {
            const std::uint32_t i = used[order[last].index];
            sum += Vec3d(points[i]);
            above += double{height[i]};
            out.of_point[i] = static_cast<std::uint32_t>(out.centroid.size());
        }
        const auto count = static_cast<double>(last - first);
        out.centroid.push_back(Vec3(sum / count));
        out.height.push_back(static_cast<float>(above / count));
        first = last;
    }
    return out;
}

/// Where paths start: the tree of a voxel that lies on a stem, `trees.size()` for understorey, else kNone.
std::vector<std::uint32_t> find_sources(const Voxels& voxels, std::span<const TreeStems> trees,
                                        const SegmentOptions& options, const Context& ctx) {
    const auto understorey = static_cast<std::uint32_t>(trees.size());
    std::vector<std::uint32_t> source(voxels.centroid.size(), kNone);
    parallel_for(ctx, source.size(), 4096, [&](std::size_t v) {
        const Vec3 p = voxels.centroid[v];
        const double h = voxels.height[v];
        double nearest = 1;  // distance over what a stem reaches
        bool at_foot = false;
        for (std::uint32_t t = 0; t < trees.size(); ++t) {
            for (const StemTrack& stem : trees[t].stems) {
                const double top = std::max(stem.sections.back().center.z, kBreast);
                if (h > top + 0.1) continue;
                const Vec3d at = stem.at(h);
                const double off = std::hypot(double{p.x} - at.x, double{p.y} - at.y);
                const double share = off / (kStemReach * stem.radius + options.voxel);
                if (share < nearest) {
                    nearest = share;
                    source[v] = t;
                }
                at_foot = at_foot || off < kFootReach * stem.radius + kFootRoom;
            }
        }
        if (source[v] == kNone && h < kFloor && !at_foot) source[v] = understorey;
    });
    return source;
}

/// Grows all sources at once along shortest paths. The way through a tree counts less the thicker its stem is
/// at breast height, and jumps over gaps count more than twice their length.
std::vector<std::uint32_t> grow(const Graph& graph, std::span<const std::uint32_t> source,
                                std::span<const double> scale, double edge, const Context& ctx) {
    struct Entry {
        double cost;
        std::uint32_t voxel;
        bool operator>(const Entry& b) const { return cost != b.cost ? cost > b.cost : voxel > b.voxel; }
    };
    std::vector<std::uint32_t> label(source.begin(), source.end());
    Buffer<double> cost(graph.size(), std::numeric_limits<double>::infinity());
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
        if (source[v] == kNone) continue;
        cost[v] = 0;
        open.push({0, v});
    }
    for (std::size_t turn = 0; !open.empty(); ++turn) {
        const auto [at, v] = open.top();
        open.pop();
        if (at > cost[v]) continue;
        poll_stop(ctx, turn);
        const double per_length = scale[label[v]];
        for (std::uint32_t e = graph.first[v]; e < graph.first[v + 1]; ++e) {
            const double length = double{graph.length[e]};
            const double next = at + per_length * length * std::max(1.0, length / (2 * edge));
            const std::uint32_t to = graph.to[e];
            if (!(next < cost[to])) continue;
            cost[to] = next;
            label[to] = label[v];
            open.push({next, to});
        }
    }
    return label;
}

/// Whether one stem leaves the other above the ground.
bool meet(const StemTrack& a, const StemTrack& b) {
    const double top = std::min(a.sections.front().center.z, b.sections.front().center.z) + 0.2;
    for (double z = 0; z <= top; z += 0.05) {
        const Vec3d p = a.at(z), q = b.at(z);
        if (std::hypot(p.x - q.x, p.y - q.y) < kMeet * (a.radius + b.radius)) return true;
    }
    return false;
}

}  // namespace

std::vector<TreeStems> trees_of_stems(std::vector<StemTrack> stems) {
    std::ranges::stable_sort(stems, std::ranges::greater{}, &StemTrack::radius);
    DisjointSets sets(stems.size());
    for (std::uint32_t i = 0; i < stems.size(); ++i) {
        for (std::uint32_t k = 0; k < i; ++k) {
            if (meet(stems[k], stems[i])) sets.join(k, i);
        }
    }
    std::vector<TreeStems> trees;
    std::vector<std::size_t> tree_of(stems.size());
    for (std::uint32_t i = 0; i < stems.size(); ++i) {
        const std::uint32_t first = sets.find(i);
        if (first == i) {
            tree_of[i] = trees.size();
            trees.emplace_back();
        }
        trees[tree_of[first]].stems.push_back(std::move(stems[i]));
    }
    return trees;
}

std::vector<std::uint32_t> give_points_to_trees(std::span<const Vec3> points, std::span<const float> height,
                                                const Terrain& terrain, std::span<const TreeStems> trees,
                                                const SegmentOptions& options, const Context& ctx) {
    std::vector<std::uint32_t> tree_of(points.size(), kNoTree);
    std::vector<std::uint32_t> used;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (terrain.is_ground && double{height[i]} < terrain.clearance) {
            tree_of[i] = kGroundPoint;
        } else {
            used.push_back(i);
        }
    }
    if (used.size() < 2 || trees.empty()) return tree_of;
    const Voxels voxels = make_voxels(points, height, used, options.voxel, ctx);
    if (voxels.centroid.size() < 2) return tree_of;
    ctx.report(0.1f);
    std::vector<std::uint32_t> label;
    {
        const std::vector<std::uint8_t> ignored(voxels.centroid.size(), 0);
        const Neighbours near = nearest_neighbours(voxels.centroid, kNeighbours, ctx);
        ctx.report(0.4f);
        const ConnectedGraph joined = connect_points(voxels.centroid, near, ignored, options.widest_gap, ctx);
        ctx.report(0.7f);
        std::vector<double> scale;
        for (const TreeStems& tree : trees) scale.push_back(std::pow(2 * tree.radius(), -kScaling));
        scale.push_back(std::pow(kUnderstorey, -kScaling));
        label = grow(joined.graph, find_sources(voxels, trees, options, ctx), scale, options.voxel, ctx);
    }
    for (const std::uint32_t i : used) {
        const std::uint32_t tree = label[voxels.of_point[i]];
        if (tree < trees.size()) tree_of[i] = tree;
    }
    ctx.report(1);
    return tree_of;
}

}  // namespace coppice::extract_internal
