#include "coppice/extract/cloud/tubes_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/bins_internal.h"
#include "coppice/extract/cloud/fit_internal.h"
#include "coppice/spatial/overlap_queries.h"

namespace coppice::extract_internal {
namespace {

struct Scale {
    double step;   ///< [spacing] distance between nodes
    double link;   ///< [spacing] maximum length of a link between points of a node
    double least;  ///< [spacing] minimum radius of a tube
    double clean;  ///< [radius] maximum residual of a tube
};

// Thick before thin: with steps of four spacings the rings of thick branches close, and bundles of twigs are
// detected by residuals that are large for their thickness. The widest steps are for clouds far denser than
// the stem, and are omitted if no stem base is thick enough.
constexpr std::array<Scale, 5> kScales{
    {{16, 2, 10, 0.08}, {8, 2, 7, 0.08}, {4, 2, 2, 0.08}, {2, 2, 1, 0.12}, {1, 2, 0.25, 0.12}}};
constexpr double kAlways = 4;  // [spacing] maximum step that is used for every cloud
// minimum ratio of the radius of a stem base to the minimum radius of a scale, for wider steps
constexpr double kBaseOfLeast = 2.4;
constexpr float kMinOfTube = 30;   // minimum number of points
constexpr double kRough = 1.4;     // factor of the minimum length of a twig on a tube
constexpr std::uint32_t kMin = 3;  // minimum number of points of a twig
constexpr double kSlack = 0.2;     // [radius] maximum distance beyond a tube of its own points

std::vector<std::uint32_t> points_beyond(const CloudTree& tree) {
    std::vector<std::uint32_t> count(tree.size(), 0);
    for (const std::uint32_t n : tree.node_of_point) {
        if (n != kNoIndex) ++count[n];
    }
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        if (tree.parent[n] != kNoIndex) count[tree.parent[n]] += count[n];
    }
    return count;
}

/// Removes branches of nodes from `first` on that extend less than `reach` beyond their fork, along paths
/// with the costs `level` at the points, or that have fewer than three points. Their points are assigned to
/// the parent branch.
void prune_twigs(CloudTree& tree, std::uint32_t first, std::span<const float> level, double reach) {
    const auto beyond = points_beyond(tree);
    std::vector<float> top(tree.size(), 0), low(tree.size(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < level.size(); ++i) {
        const std::uint32_t n = tree.node_of_point[i];
        if (n == kNoIndex || n < first) continue;
        top[n] = std::max(top[n], level[i]);
        low[n] = std::min(low[n], level[i]);
    }
    std::vector<std::uint32_t> next(tree.size(), kNoIndex);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t parent = tree.parent[n];
        if (parent == kNoIndex) continue;
        if (next[parent] == kNoIndex || top[n] >= top[next[parent]]) next[parent] = n;
        top[parent] = std::max(top[parent], top[n]);
    }
    std::vector<std::uint8_t> kept(tree.size(), 1);
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const std::uint32_t parent = tree.parent[n];
        if (parent == kNoIndex) continue;
        kept[n] = kept[parent];
        const bool on_tube = parent < first;
        if (!kept[n] || (next[parent] == n && !on_tube)) continue;
        const double least = on_tube ? kRough * reach : reach;
        if (top[n] - low[n] >= least && beyond[n] >= kMin) continue;
        kept[n] = 0;
    }
    keep_nodes(tree, kept, true);
}

/// Keeps, of the nodes from `first` on, sequences with good fits that are thick relative to the spacing.
void keep_tubes(CloudTree& tree, std::uint32_t first, std::span<const float> spacing, const Scale& scale,
                double thickest) {
    std::vector<double> sum(tree.size(), 0);
    std::vector<std::uint32_t> count(tree.size(), 0);
    for (std::size_t i = 0; i < spacing.size(); ++i) {
        const std::uint32_t n = tree.node_of_point[i];
        if (n == kNoIndex || n < first) continue;
        sum[n] += spacing[i];
        ++count[n];
    }
    std::vector<std::uint8_t> clean(tree.size(), 1), kept(tree.size(), 1);
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const double about = count[n] == 0 ? 0 : sum[n] / count[n];
        clean[n] = tree.weight[n] >= kMinOfTube && tree.radius[n] > scale.least * about &&
                   tree.residual[n] < scale.clean * tree.radius[n] && tree.radius[n] <= thickest;
        kept[n] = 0;
    }
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const std::uint32_t parent = tree.parent[n];
        if (parent != kNoIndex && parent >= first && clean[n] && clean[parent]) {
            kept[n] = kept[parent] = 1;
        } else {
            tree.parent[n] = kNoIndex;
        }
    }
    keep_nodes(tree, kept, false);
}

/// Returns the section of the axis between a node and its parent that claims points.
RoundCone tube_at(const CloudTree& tree, std::uint32_t n) {
    const std::uint32_t q = tree.parent[n];
    // A thin branch does not start with the thickness of its parent branch.
    const double start = std::min(tree.radius[q], 1.5 * tree.radius[n]);
    return round_cone(tree.position[q], tree.position[n], start, tree.radius[n]);
}

/// Assigns the points on kept branches to them; unassigns the others.
void assign_to_tubes(CloudTree& tree, std::span<const Vec3> points, std::span<const float> spacing,
                     const Context& ctx) {
    std::vector<RoundCone> tubes;
    std::vector<Box3> boxes;
    std::vector<std::uint32_t> owner;
    const double widest = spacing.empty() ? 0 : double{*std::ranges::max_element(spacing)};
    const auto compute_reach = [&](std::uint32_t n, double radius, double about) {
        return tree.fixed[n] ? reach_of_stem(radius, about) : (1 + kSlack) * radius;
    };
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNoIndex) continue;
        const RoundCone& tube = tubes.emplace_back(tube_at(tree, n));
        const double reach = compute_reach(n, std::max(tube.radius_a, tube.radius_b()), widest);
        boxes.push_back(capsule_box(Vec3(tube.a), Vec3(tube.b()), static_cast<float>(reach) * 1.0001f));
        owner.push_back(n);
    }
    const BoxTree index(boxes, ctx);
    parallel_for_ranges(ctx, points.size(), 4096, [&](IndexRange range) {
        const auto compute_box = [&](std::size_t i) { return Box3{points[i], points[i]}; };
        OverlapQueries(index, boxes)
            .visit(range, compute_box, [&](std::size_t i, std::span<const std::uint32_t> near) {
                double best = 1;
                std::uint32_t found = kNoIndex;
                for (const std::uint32_t item : near) {
                    const std::uint32_t n = owner[item];
                    const RoundCone::ClosestPoint closest = tubes[item].closest_point(Vec3d(points[i]));
                    const double rho =
                        closest.distance() / compute_reach(n, closest.radius, double{spacing[i]});
                    if (rho > best || (rho == best && found != kNoIndex)) continue;
                    best = rho;
                    found = closest.t < 0.5 ? tree.parent[n] : n;
                }
                tree.node_of_point[i] = found;
            });
    });
}

/// Returns half the width of the widest stem base [spacing]; infinity if one is a single point specified by
/// the user.
double widest_base(std::span<const Vec3> points, StemBases bases, std::span<const float> spacing) {
    double thickest = 0;
    for (const auto& base : bases) {
        if (base.size() == 1) return std::numeric_limits<double>::infinity();
        Box3 box;
        double sum = 0;
        for (const std::uint32_t p : base) {
            box.extend(points[p]);
            sum += spacing[p];
        }
        const double wide = 0.5 * double{std::max(box.size().x, box.size().y)};
        thickest = std::max(thickest, wide * static_cast<double>(base.size()) / sum);
    }
    return thickest;
}

/// Returns the scales for stem bases of this thickness [spacing].
std::vector<Scale> scales_for(double thickest) {
    std::vector<Scale> scales;
    std::ranges::copy_if(kScales, std::back_inserter(scales), [&](const Scale& scale) {
        return scale.step <= kAlways || thickest >= kBaseOfLeast * scale.least;
    });
    return scales;
}

/// Adds the stems, which are known tubes.
void add_stems(CloudTree& tree, std::span<const StemAxis> stems) {
    for (const StemAxis& stem : stems) {
        std::uint32_t last = kNoIndex;
        for (std::size_t i = 0; i < stem.position.size(); ++i)
            last = tree.add(last, stem.position[i], stem.radius[i], true);
    }
}

/// Returns the sources of the paths of the next scale: all assigned points, and the bases.
std::vector<std::uint32_t> find_sources(const CloudTree& tree, StemBases bases) {
    std::vector<std::uint32_t> sources;
    for (std::uint32_t p = 0; p < tree.node_of_point.size(); ++p) {
        if (tree.node_of_point[p] != kNoIndex) sources.push_back(p);
    }
    for (const auto& base : bases) {
        for (const std::uint32_t p : base)
            if (tree.node_of_point[p] == kNoIndex) sources.push_back(p);
    }
    return sources;
}

}  // namespace

CloudTree find_tubes(std::span<const Vec3> points, const Graph& graph, std::span<const StemAxis> stems,
                     StemBases bases, std::span<const float> spacing, const TubeOptions& options,
                     const Context& ctx) {
    CloudTree tree;
    tree.node_of_point.assign(points.size(), kNoIndex);
    add_stems(tree, stems);
    assign_to_tubes(tree, points, spacing, ctx);
    const std::uint32_t of_stems = tree.size();
    Paths paths;
    std::uint32_t known = of_stems;  // number of nodes of the tree that the paths start from
    const std::vector<Scale> scales = scales_for(widest_base(points, bases, spacing));
    float done = 0;
    for (const Scale& scale : scales) {
        ctx.report(done++ / static_cast<float>(scales.size()));
        const std::uint32_t first = tree.size();
        // If a scale finds no tubes, the paths of the next one are the same.
        if (paths.order.empty() || first != known)
            paths = shortest_paths(graph, find_sources(tree, bases), tree.node_of_point, {spacing}, ctx);
        known = first;
        const double step = scale.step * options.step;
        bin_paths(tree, points, graph, paths,
                  {step, scale.link, first == of_stems ? bases : StemBases{}, spacing}, ctx);
        prune_twigs(tree, first, paths.distance, step);
        fit_axes(tree, first, points, options.passes, ctx);
        keep_tubes(tree, first, spacing, scale, options.thickest);
        assign_to_tubes(tree, points, spacing, ctx);
    }
    return tree;
}

}  // namespace coppice::extract_internal
