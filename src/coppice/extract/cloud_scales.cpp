#include "coppice/extract/cloud_scales_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/extract/cloud_fit_internal.h"
#include "coppice/extract/cloud_shape_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::extract_internal {
namespace {

struct Scale {
    double step;   ///< [spacing] between nodes
    double link;   ///< [spacing] longest that holds a node's points together
    double least;  ///< [spacing] radius of the thinnest tube that is kept
    double clean;  ///< [radius] greatest residual of a tube that is kept
};

// Thick before thin: with steps of four spacings the rings of thick branches close, and bundles of twigs show
// by residuals that are large for their thickness.
constexpr std::array<Scale, 4> kScales{
    {{4, 2, 2, 0.08}, {2, 2, 1, 0.12}, {1, 2, 0.25, 0.12}, {1, 1.5, 0, 0}}};
constexpr float kFewestOfTube = 12;  // points
constexpr double kSlack = 0.2;       // [radius] beyond a tube, up to which points are its own

/// Keeps, of the nodes from `first` on, clean tubes that are thick against the spacing, and roots.
void keep_tubes(CloudTree& tree, std::uint32_t first, std::span<const float> spacing, const Scale& scale) {
    std::vector<double> sum(tree.size(), 0);
    std::vector<std::uint32_t> count(tree.size(), 0);
    for (std::size_t i = 0; i < spacing.size(); ++i) {
        const std::uint32_t n = tree.node_of_point[i];
        if (n == kNone || n < first) continue;
        sum[n] += spacing[i];
        ++count[n];
    }
    std::vector<std::uint8_t> kept(tree.size(), 1);
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        if (tree.parent[n] == kNone) continue;
        const double about = count[n] == 0 ? 0 : sum[n] / count[n];
        kept[n] = tree.weight[n] >= kFewestOfTube && tree.radius[n] > scale.least * about &&
                  tree.residual[n] < scale.clean * tree.radius[n];
    }
    keep_nodes(tree, kept, false);
}

/// The part of the axis between a node and its parent, as tubes claim points.
struct Tube {
    Vec3d a, d;
    double ra, rb;
    explicit Tube(const CloudTree& tree, std::uint32_t n)
        : a(tree.position[tree.parent[n]]),
          d(tree.position[n] - a),
          // A thin branch does not start as thick as what it leaves.
          ra(std::min(tree.radius[tree.parent[n]], 1.5 * tree.radius[n])),
          rb(tree.radius[n]) {}
};

/// Gives the points on kept branches to them, and takes the others back.
void claim_points(CloudTree& tree, std::span<const Vec3> points, const Context& ctx) {
    std::vector<Box3> boxes;
    std::vector<std::uint32_t> owner;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNone) continue;
        const Tube tube(tree, n);
        const auto reach = static_cast<float>((1 + kSlack) * std::max(tube.ra, tube.rb));
        boxes.push_back(capsule_box(Vec3(tube.a), Vec3(tube.a + tube.d), reach * 1.0001f));
        owner.push_back(n);
    }
    const BoxTree index(boxes, ctx);
    parallel_for(ctx, points.size(), 4096, [&](std::size_t i) {
        double best = 1 + kSlack;
        std::uint32_t found = kNone;
        const Vec3d p(points[i]);
        index.visit_overlapping({points[i], points[i]}, [&](std::uint32_t item) {
            const std::uint32_t n = owner[item];
            const Tube tube(tree, n);
            const double squared = dot(tube.d, tube.d);
            const double t = squared > 0 ? std::clamp(dot(p - tube.a, tube.d) / squared, 0.0, 1.0) : 0.0;
            const double rho = length(p - tube.a - tube.d * t) / std::lerp(tube.ra, tube.rb, t);
            if (rho > best || (rho == best && found != kNone)) return;
            best = rho;
            found = t < 0.5 ? tree.parent[n] : n;
        });
        tree.node_of_point[i] = found;
    });
}

/// Where paths of the next scale start: at the roots, or at all that is explained.
std::vector<std::uint32_t> sources_of(const CloudTree& tree,
                                      std::span<const std::vector<std::uint32_t>> roots) {
    std::vector<std::uint32_t> sources;
    for (std::uint32_t p = 0; p < tree.node_of_point.size(); ++p) {
        if (tree.node_of_point[p] != kNone) sources.push_back(p);
    }
    if (sources.empty()) {
        for (const auto& root : roots) sources.insert(sources.end(), root.begin(), root.end());
    }
    return sources;
}

}  // namespace

CloudTree grow_tree(std::span<const Vec3> points, const Graph& graph,
                    std::span<const std::vector<std::uint32_t>> roots, std::span<const float> spacing,
                    const ScaleOptions& options, std::uint32_t& pruned, const Context& ctx) {
    CloudTree tree;
    tree.node_of_point.assign(points.size(), kNone);
    for (std::size_t k = 0; k < kScales.size(); ++k) {
        const Scale& scale = kScales[k];
        const bool last = k + 1 == kScales.size();
        const std::uint32_t first = tree.size();
        const Paths paths = shortest_paths(graph, sources_of(tree, roots), tree.node_of_point, spacing, ctx);
        const double step = scale.step * options.step;
        bin_paths(tree, points, graph, paths,
                  first == 0 ? roots : std::span<const std::vector<std::uint32_t>>{}, spacing,
                  {step, scale.link}, ctx);
        const std::uint32_t gone = prune_twigs(tree, first, paths.distance, last ? options.reach : step);
        if (last) pruned = gone;
        fit_axes(tree, first, points, options.passes, ctx);
        if (last) break;
        keep_tubes(tree, first, spacing, scale);
        claim_points(tree, points, ctx);
        ctx.report(0.4f + 0.12f * static_cast<float>(k + 1));
    }
    return tree;
}

}  // namespace coppice::extract_internal
