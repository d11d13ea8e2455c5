#include "coppice/extract/points/gaps_internal.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/normal_dispersion_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::extract_internal {
namespace {

constexpr std::uint32_t
    kVoxelNeighbours = 10,
    kVoxelRank = 4;  // number of neighbours of a voxel; rank of the neighbour that defines the spacing
constexpr double kOfExtent = 0.3, kOfExtentAligned = 0.5;  // [extent of a component] maximum gap to it
// cost factor of an aligned gap, relative to a path of the same length over points
constexpr double kUnseen = 3;

/// Finds the closest points of other components in a hierarchy of boxes; skips boxes with points of one
/// component only.
class NearestOther {
  public:
    NearestOther(std::span<const Vec3> points, std::span<const std::uint8_t> ignored, const Context& ctx)
        : points_(points), tree_(compute_boxes(points, ignored, used_), ctx) {
        for (std::uint32_t l = 0; l < tree_.level_count(); ++l) part_.emplace_back(tree_.level(l).size());
    }

    std::span<const std::uint32_t> used() const { return used_; }

    void set_parts(std::span<const std::uint32_t> part_of) {
        part_of_ = part_of;
        for (std::uint32_t i = 0; i < part_[0].size(); ++i) part_[0][i] = part_of[used_[tree_.item(i)]];
        for (std::uint32_t l = 1; l < part_.size(); ++l) {
            for (std::uint32_t i = 0; i < part_[l].size(); ++i) {
                const std::uint32_t begin = BoxTree::kWidth * i;
                const auto end = std::min<std::uint32_t>(begin + BoxTree::kWidth,
                                                         static_cast<std::uint32_t>(part_[l - 1].size()));
                part_[l][i] = part_[l - 1][begin];
                for (std::uint32_t c = begin; c < end; ++c) {
                    if (part_[l - 1][c] != part_[l][i]) part_[l][i] = kNoIndex;
                }
            }
        }
    }

    /// Reduces `squared` and sets `found` if a point of another component is closer.
    void search(std::uint32_t point, double& squared, std::uint32_t& found) const {
        const Vec3d p(points_[point]);
        const std::uint32_t own = part_of_[point];
        const auto bound = [&](std::uint32_t level, std::uint32_t i) {
            if (part_[level][i] == own) return std::numeric_limits<double>::infinity();
            return distance_squared(tree_.level(level)[i], p);
        };
        tree_.search(bound, squared, [&](std::uint32_t item) {
            const double d = length_squared(Vec3d(points_[used_[item]]) - p);
            if (d >= squared) return;
            squared = d;
            found = used_[item];
        });
    }

  private:
    static std::vector<Box3> compute_boxes(std::span<const Vec3> points,
                                           std::span<const std::uint8_t> ignored,
                                           std::vector<std::uint32_t>& used) {
        std::vector<Box3> boxes;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (ignored[i]) continue;
            used.push_back(i);
            boxes.push_back({points[i], points[i]});
        }
        return boxes;
    }

    std::span<const Vec3> points_;
    std::span<const std::uint32_t> part_of_;
    std::vector<std::uint32_t> used_;
    BoxTree tree_;
    std::vector<std::vector<std::uint32_t>> part_;  ///< component of each box of a level; kNoIndex = several
};

/// End of a limb: a voxel with all surrounding points on one side, in a line.
struct LimbEnd {
    std::uint32_t place;
    Vec3d outward;  ///< unit vector
};

/// Returns the end of a limb at a voxel, if any; `edge` [m] is the edge of the voxels.
std::optional<LimbEnd> limb_end_at(std::span<const Vec3> at, const Neighbours& near, std::uint32_t v,
                                   double edge) {
    constexpr double kReach = 5, kMaxBeyond = 0.4;  // [edge] radius about the voxel; maximum extent beyond it
    // minimum share of the variance along the first axis in excess of the others
    constexpr double kLinear = 0.8;
    constexpr int kMin = 3;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Vec3d mean;
    int count = 0;
    for (std::uint32_t k = 0; k < near.count && double{near.distances(v)[k]} <= kReach * edge; ++k, ++count) {
        const Vec3d off = Vec3d(at[near.of(v)[k]]) - Vec3d(at[v]);
        const Eigen::Vector3d e(off.x, off.y, off.z);
        sum += e * e.transpose();
        mean += off;
    }
    if (count < kMin) return {};
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(sum);
    const auto& spread = solver.eigenvalues();
    if (!(spread[2] - spread[1] > kLinear * spread[2])) return {};
    const Eigen::Vector3d axis = solver.eigenvectors().col(2);
    Vec3d outward{axis[0], axis[1], axis[2]};
    if (dot(outward, mean) > 0) outward = outward * -1;
    for (int k = 0; k < count; ++k) {
        const Vec3d off = Vec3d(at[near.of(v)[static_cast<std::size_t>(k)]]) - Vec3d(at[v]);
        if (dot(off, outward) > kMaxBeyond * edge) return {};
    }
    return LimbEnd{v, outward};
}

/// Representative points of the voxels of one size.
struct VoxelPoints {
    std::vector<std::uint32_t> point;  ///< per non-empty voxel, the point closest to the mean
    Buffer<Vec3> at;                   ///< [m] positions of these points
};

/// Adds links of at most `limit` [m] between ends of limbs of different components that point at each other:
/// of each end to the best other one.
void link_ends(const VoxelPoints& voxels, const Neighbours& near, const Components& parts, double edge,
               double limit, std::vector<Link>& links, const Context& ctx) {
    constexpr std::uint32_t kOthers = 32;  // number of adjacent ends considered per end
    constexpr double kAligned = 0.87;      // minimum cosine between both ends and the line between them
    constexpr double kBend = 4;            // weight of (1 - cosine) of both bends, relative to the length
    std::vector<std::optional<LimbEnd>> found(voxels.at.size());
    parallel_for(ctx, found.size(), 1024, [&](std::size_t v) {
        found[v] = limb_end_at(voxels.at, near, static_cast<std::uint32_t>(v), edge);
    });
    std::vector<LimbEnd> ends;
    Buffer<Vec3> place;
    for (const auto& end : found) {
        if (!end) continue;
        ends.push_back(*end);
        place.push_back(voxels.at[end->place]);
    }
    if (ends.size() < 2) return;
    const Neighbours others = nearest_neighbours(place, kOthers, ctx);
    for (std::uint32_t e = 0; e < ends.size(); ++e) {
        const std::uint32_t from = voxels.point[ends[e].place];
        Link best{kNoIndex, kNoIndex, 0};
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t k = 0; k < others.count; ++k) {
            const LimbEnd& other = ends[others.of(e)[k]];
            const std::uint32_t to = voxels.point[other.place];
            const double length = double{others.distances(e)[k]};
            if (length > limit || !(length > 0) || parts.of[from] == parts.of[to]) continue;
            const Vec3d way = (Vec3d(voxels.at[other.place]) - Vec3d(place[e])) / length;
            const double out = dot(ends[e].outward, way), in = -dot(other.outward, way);
            const double cost = length * (1 + kBend * (2 - out - in));
            if (out < kAligned || in < kAligned || cost >= least) continue;
            least = cost;
            best = {from, to, static_cast<float>(length)};
        }
        if (best.from != kNoIndex) links.push_back(best);
    }
}

/// Merges representative points into those of voxels of this edge [m].
VoxelPoints merge_voxels(const VoxelPoints& from, double edge, const Context& ctx) {
    const VoxelGrid grid = voxel_grid(from.at, edge, ctx);
    std::vector<std::uint32_t> best(grid.centroid.size(), kNoIndex);
    std::vector<float> off(best.size(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < from.at.size(); ++i) {
        const std::uint32_t v = grid.of_point[i];
        const float d = length_squared(from.at[i] - grid.centroid[v]);
        if (d >= off[v]) continue;
        off[v] = d;
        best[v] = i;
    }
    VoxelPoints out;
    for (const std::uint32_t i : best) {
        out.point.push_back(from.point[i]);
        out.at.push_back(from.at[i]);
    }
    return out;
}

/// Links across gaps between components.
struct GapLinks {
    std::vector<Link> close;    ///< between the closest representative points of increasing voxels
    std::vector<Link> aligned;  ///< between ends of limbs that continue each other
};

/// Returns links of at most `limit` [m]; `spacing` [m] is the median spacing of the points.
GapLinks find_gap_links(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                        const Components& parts, double limit, double spacing, const Context& ctx) {
    VoxelPoints voxels;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
        if (ignored[p]) continue;
        voxels.point.push_back(p);
        voxels.at.push_back(points[p]);
    }
    GapLinks links;
    for (double edge = 2 * spacing; edge <= limit && voxels.at.size() > 1; edge *= 2) {
        voxels = merge_voxels(voxels, edge, ctx);
        const Neighbours near = nearest_neighbours(voxels.at, kVoxelNeighbours, ctx);
        for (std::uint32_t v = 0; v < voxels.at.size(); ++v) {
            for (std::uint32_t k = 0; k < near.count; ++k) {
                const std::uint32_t w = near.of(v)[k], from = voxels.point[v], to = voxels.point[w];
                const float length = near.distances(v)[k];
                if (parts.of[from] == parts.of[to] || double{length} > limit || (w < v && near.lists(w, v)))
                    continue;
                links.close.push_back({from, to, length});
            }
        }
        link_ends(voxels, near, parts, edge, limit, links.aligned, ctx);
    }
    return links;
}

/// Returns the maximum gap [m] to each component: a share of its extent.
std::vector<double> reach_of_parts(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                                   const Components& parts, const GapRule& gap, double share) {
    constexpr std::uint32_t kMin = 20;  // minimum number of points
    std::vector<Box3> box(parts.size.size());
    for (std::uint32_t p = 0; p < points.size(); ++p)
        if (!ignored[p]) box[parts.of[p]].extend(points[p]);
    std::vector<double> out(box.size(), 0);
    for (std::size_t i = 0; i < box.size(); ++i)
        if (parts.size[i] >= kMin)
            out[i] = std::clamp(share * double{box[i].diagonal()}, gap.usual, gap.widest);
    return out;
}

}  // namespace

std::vector<Link> bridge_gaps(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                              const Components& parts, double limit, const Context& ctx) {
    std::vector<Link> bridges;
    if (parts.size.size() < 2) return bridges;
    NearestOther nearest(points, ignored, ctx);
    DisjointSets sets(parts.size.size());
    std::vector<std::uint32_t> part_of = parts.of;
    const auto members = compress_rows<std::uint32_t>(parts.size.size(), [&](const auto& put) {
        for (const std::uint32_t p : nearest.used()) put(parts.of[p], p);
    });
    for (bool joined = true; joined;) {
        for (std::uint32_t i = 0; i < part_of.size(); ++i) part_of[i] = sets.find(parts.of[i]);
        nearest.set_parts(part_of);
        std::vector<Link> best(parts.size.size(), {kNoIndex, kNoIndex, 0});
        parallel_for(ctx, parts.size.size(), 16, [&](std::size_t part) {
            double squared = limit * limit;
            for (const std::uint32_t p : members[part]) {
                if (ctx.stop.stop_requested()) return;  // one component may contain nearly all points
                std::uint32_t found = kNoIndex;
                nearest.search(p, squared, found);
                if (found != kNoIndex) best[part] = {p, found, static_cast<float>(std::sqrt(squared))};
            }
        });
        // Of components that are already joined only the shortest link counts; ties use the smaller index.
        std::vector<Link> chosen(parts.size.size(), {kNoIndex, kNoIndex, 0});
        for (std::uint32_t part = 0; part < best.size(); ++part) {
            Link& out = chosen[sets.find(part)];
            if (best[part].from != kNoIndex && (out.from == kNoIndex || best[part].length < out.length))
                out = best[part];
        }
        joined = false;
        for (const Link& link : chosen) {
            if (link.from == kNoIndex || !sets.join(parts.of[link.from], parts.of[link.to])) continue;
            bridges.push_back(link);
            joined = true;
        }
    }
    return bridges;
}

ConnectedGraph connect_points(std::span<const Vec3> points, const Neighbours& neighbours,
                              std::span<const std::uint8_t> ignored, const GapRule& gap, const Context& ctx) {
    ConnectedGraph out;
    out.components = components(neighbours, ignored, {}, ctx, gap.usual);
    out.bridges = bridge_gaps(points, ignored, out.components, gap.usual, ctx);
    std::vector<Link> links = out.bridges;
    const double spacing = median(local_spacing(neighbours, std::min(kVoxelRank, neighbours.count)));
    const GapLinks across = find_gap_links(points, ignored, out.components, gap.widest, spacing, ctx);
    for (const Link& link : across.close)
        if (double{link.length} <= gap.usual) links.push_back(link);
    if (!links.empty()) out.components = components(neighbours, ignored, links, ctx, gap.usual);
    const auto add_wide = [&](std::span<const Link> more, double share, bool within, const auto& cost) {
        const std::vector<double> reach = reach_of_parts(points, ignored, out.components, gap, share);
        for (Link link : more) {
            const std::uint32_t a = out.components.of[link.from], b = out.components.of[link.to];
            if (a == b ? !within : double{link.length} > std::min(reach[a], reach[b])) continue;
            link.length = cost(link.length);
            links.push_back(link);
        }
    };
    std::vector<Link> close = bridge_gaps(points, ignored, out.components, gap.widest, ctx);
    close.insert(close.end(), across.close.begin(), across.close.end());
    add_wide(close, kOfExtent, false, [](float length) { return length; });
    add_wide(across.aligned, kOfExtentAligned, true,
             [&](float length) { return static_cast<float>(std::sqrt(kUnseen * double{length} * spacing)); });
    out.graph = make_graph(neighbours, ignored, links, ctx, gap.usual);
    const std::size_t before = out.components.size.size();
    out.components = components(out.graph, ctx);
    out.wide = static_cast<std::uint32_t>(before - out.components.size.size());
    return out;
}

}  // namespace coppice::extract_internal
