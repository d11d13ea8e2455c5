#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <queue>
#include <tuple>
#include <utility>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/plot/segments_internal.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::uint32_t kNeighbours = 10;
constexpr double kStemReach = 1.3;  // [radius] maximum distance from the axis of a stem of its own points
// [radius] radius about a stem without understorey, in addition to kFootRoom
constexpr double kFootReach = 3;
constexpr double kFootRoom = 0.3;       // [m]
constexpr double kFloor = 0.3;          // [m] maximum height of understorey above the ground
constexpr double kUnderstorey = 0.005;  // [m] diameter at breast height assumed for understorey
constexpr double kScaling = 1.0 / 3;    // exponent of the diameter that normalizes path lengths in trees
// [m] minimum length of a path over which its direction is measured; also in voxels
constexpr double kCourse = 0.2;
constexpr double kCourseVoxels = 4;
constexpr double kTurn = 4;        // [m/rad] cost of a bend
constexpr double kFreeTurn = 0.3;  // [rad] bend without cost
constexpr double kMeet = 1.1;      // [sum of two radii] maximum distance of stems that meet below
constexpr double kBreast = 1.3;    // [m]

/// Non-empty voxels along the Morton curve, and the voxel of each point.
struct Voxels {
    Buffer<Vec3> centroid;
    Buffer<float> height;  ///< [m] mean height above the ground
    Buffer<std::uint32_t> of_point;
};

Voxels make_voxels(std::span<const Vec3> points, std::span<const float> height,
                   std::span<const std::uint32_t> used, double edge, const Context& ctx) {
    Buffer<Vec3> place(used.size());
    for (std::size_t i = 0; i < used.size(); ++i) place[i] = points[used[i]];
    const Buffer<MortonPlace> order = morton_order(place, edge, ctx);
    Voxels out;
    out.of_point.assign(points.size(), kNoIndex);
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

/// Columns of 10 cm with points above the floor: roots that rise to a stem, not litter about its foot.
class RisingColumns {
  public:
    explicit RisingColumns(const Voxels& voxels) {
        constexpr double kRise = 0.5;  // [m] above the floor
        for (std::size_t v = 0; v < voxels.centroid.size(); ++v) {
            const double h = voxels.height[v];
            if (h > kFloor && h < kFloor + kRise) keys_.push_back(key(voxels.centroid[v]));
        }
        std::ranges::sort(keys_);
    }
    bool holds(Vec3 p) const { return std::ranges::binary_search(keys_, key(p)); }

  private:
    static std::pair<std::int64_t, std::int64_t> key(Vec3 p) {
        return {std::llround(10 * double{p.x}), std::llround(10 * double{p.y})};
    }
    std::vector<std::pair<std::int64_t, std::int64_t>> keys_;
};

/// Returns the sources of paths: the tree of a voxel on a stem, `trees.size()` for understorey, otherwise
/// kNoIndex.
std::vector<std::uint32_t> find_sources(const Voxels& voxels, std::span<const TreeStems> trees,
                                        const SegmentOptions& options, const Context& ctx) {
    const auto understorey = static_cast<std::uint32_t>(trees.size());
    std::vector<std::uint32_t> source(voxels.centroid.size(), kNoIndex);
    const RisingColumns rising(voxels);
    parallel_for(ctx, source.size(), 4096, [&](std::size_t v) {
        const Vec3 p = voxels.centroid[v];
        const double h = voxels.height[v];
        double nearest = 1;  // distance divided by the reach of a stem
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
        if (source[v] == kNoIndex && h < kFloor && !(at_foot && rising.holds(p))) source[v] = understorey;
    });
    return source;
}

/// End of a path, and its direction.
struct PathEnd {
    double cost = std::numeric_limits<double>::infinity();
    std::uint32_t tree = kNoIndex;  ///< tree of its source
    Vec3 from;                      ///< [m] position at which its direction was last measured
    Vec3 along;                     ///< this direction, a unit vector
    float since = 0;                ///< [m] length of the path since then
};

/// Grows all sources at once along shortest paths. The cost of a path through a tree decreases with the
/// diameter of the stem at breast height; jumps over gaps cost more than twice their length, and bends have a
/// cost: where branches of two trees cross, each continues straight on. For this, paths of two trees may pass
/// through a voxel, which belongs to the closer one.
class PathGrowth {
  public:
    PathGrowth(std::span<const Vec3> place, const Graph& graph, std::span<const double> scale, double edge)
        : place_(place),
          graph_(graph),
          scale_(scale),
          edge_(edge),
          stretch_(std::max(kCourse, kCourseVoxels * edge)),
          ends_(graph.size()) {}

    /// Returns the tree of each voxel, kNoIndex if no path reaches it.
    std::vector<std::uint32_t> run(std::span<const std::uint32_t> source, const Context& ctx) {
        for (std::uint32_t v = 0; v < graph_.size(); ++v)
            if (source[v] != kNoIndex) arrive(v, {0, source[v], place_[v], {0, 0, 1}, 0});
        for (std::size_t turn = 0; !open_.empty(); ++turn) {
            const Entry next = open_.top();
            open_.pop();
            poll_stop(ctx, turn);
            for (const PathEnd& end : ends_[next.voxel])
                if (end.tree == next.tree && end.cost == next.cost) leave(next.voxel, PathEnd(end));
        }
        std::vector<std::uint32_t> tree(graph_.size());
        for (std::uint32_t v = 0; v < graph_.size(); ++v)
            tree[v] = std::ranges::min(ends_[v], {}, &PathEnd::cost).tree;
        return tree;
    }

  private:
    struct Entry {
        double cost;
        std::uint32_t voxel, tree;
        bool operator>(const Entry& b) const {
            return std::tie(cost, voxel, tree) > std::tie(b.cost, b.voxel, b.tree);
        }
    };

    void leave(std::uint32_t v, const PathEnd& end) {
        for (std::uint32_t e = graph_.first[v]; e < graph_.first[v + 1]; ++e) {
            const std::uint32_t to = graph_.to[e];
            const double length = double{graph_.length[e]};
            double way = length * std::max(1.0, length / (2 * edge_));
            PathEnd next = end;
            next.since += graph_.length[e];
            if (double{next.since} >= stretch_) {
                next.along = normalized(place_[to] - end.from);
                const double bend = std::acos(std::clamp(double{dot(next.along, end.along)}, -1.0, 1.0));
                way += kTurn * std::max(0.0, bend - kFreeTurn);
                next.from = place_[to];
                next.since = 0;
            }
            next.cost = end.cost + scale_[end.tree] * way;
            arrive(to, next);
        }
    }

    /// Stores the end if it is the shortest of its tree at v, and one of the two shortest of all trees.
    void arrive(std::uint32_t v, const PathEnd& end) {
        auto& [a, b] = ends_[v];
        PathEnd* slot = a.tree == end.tree ? &a : b.tree == end.tree ? &b : a.cost > b.cost ? &a : &b;
        if (!(end.cost < slot->cost)) return;
        *slot = end;
        open_.push({end.cost, v, end.tree});
    }

    std::span<const Vec3> place_;
    const Graph& graph_;
    std::span<const double> scale_;
    double edge_, stretch_;
    std::vector<std::array<PathEnd, 2>> ends_;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

/// Returns whether two stems meet above the ground.
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
        const ConnectedGraph joined =
            connect_points(voxels.centroid, near, ignored, {options.widest_gap, options.widest_gap}, ctx);
        ctx.report(0.7f);
        std::vector<double> scale;
        for (const TreeStems& tree : trees) scale.push_back(std::pow(2 * tree.radius(), -kScaling));
        scale.push_back(std::pow(kUnderstorey, -kScaling));
        label = PathGrowth(voxels.centroid, joined.graph, scale, options.voxel)
                    .run(find_sources(voxels, trees, options, ctx), ctx);
    }
    for (const std::uint32_t i : used) {
        const std::uint32_t tree = label[voxels.of_point[i]];
        if (tree < trees.size()) tree_of[i] = tree;
    }
    ctx.report(1);
    return tree_of;
}

}  // namespace coppice::extract_internal
