#include "coppice/extract/plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/plot/segments_internal.h"
#include "coppice/extract/stem/stem_form_internal.h"
#include "coppice/points/spacing.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

using namespace extract_internal;

static_assert(kPointOfGround == kGroundPoint && kPointOfNoTree == kNoTree);

constexpr std::size_t kMinPoints = 20;
constexpr double kMaxVoxels = 1.5e6;
constexpr double kFinest = 0.02;  // [m] minimum edge of voxels
constexpr double kMinHeight = 2;  // [m] minimum height of a tree
constexpr std::size_t kMinOfTree = 50;
constexpr double kFewerCoverage = 0.35,
                 // minimum coverage, maximum relative deviation of a diameter without a warning
    kMaxDeviation = 0.05;
constexpr float kGroundFound = 0.06f, kStemsFound = 0.25f;
constexpr float kPointsGiven = 0.95f;  // progress of segment_plot after each stage
constexpr float kSegmented = 0.3f;     // progress of extract_plot after the segmentation

void check_points(const PointSet& set) {
    if (set.size() < kMinPoints)
        throw InvalidInput(
            fmt::format("extract: {} points are left in the cloud, but a plot needs at least {}", set.size(),
                        kMinPoints));
    if (set.size() > std::numeric_limits<std::uint32_t>::max() / 2)
        throw InvalidInput(
            fmt::format("extract: {} points are too many; downsample the cloud to 2^31 first", set.size()));
}

/// Returns the edge [m] at which the number of voxels is below the limit: points are on surfaces, so that the
/// number decreases with the square of the edge.
double compute_resolution(const PointSet& set, const PlotOptions& options, const Context& ctx) {
    if (options.resolution > 0) return options.resolution;
    const double spacing = median_spacing(set, ctx);
    const double share = static_cast<double>(set.size()) / kMaxVoxels;
    return std::clamp(std::max(2 * spacing, spacing * std::sqrt(std::max(share, 1.0)) * 2), kFinest, 0.5);
}

/// Finds stems in the points near the ground.
std::vector<TreeStems> find_trees(std::span<const Vec3> points, std::span<const float> height,
                                  const Terrain& terrain, const PlotOptions& options, double noise,
                                  const Context& ctx) {
    constexpr float kHighest = 4;  // [m] maximum height used by find_stems
    std::vector<Vec3> low;
    std::vector<float> above;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (height[i] > kHighest || double{height[i]} < terrain.clearance) continue;
        low.push_back(points[i]);
        above.push_back(height[i]);
    }
    const StemSearch search{.min_radius = 0.4 * double{options.min_diameter},
                            .max_radius = 0.5 * double{options.max_diameter},
                            .noise = noise};
    return trees_of_stems(find_stems(low, above, search, ctx));
}

/// Returns the points of every tree, in their order.
std::vector<Buffer<Vec3>> points_of_trees(std::span<const Vec3> points,
                                          std::span<const std::uint32_t> tree_of, std::size_t trees) {
    std::vector<std::size_t> count(trees, 0);
    for (const std::uint32_t t : tree_of)
        if (t < trees) ++count[t];
    std::vector<Buffer<Vec3>> out(trees);
    for (std::size_t t = 0; t < trees; ++t) out[t].reserve(count[t]);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (tree_of[i] < trees) out[tree_of[i]].push_back(points[i]);
    return out;
}

/// Returns whether the tree is thick enough, high enough and has enough points.
bool is_tree(const StemForm& form, std::size_t points, const PlotOptions& options) {
    const bool thick = form.breast.diameter == 0 || form.breast.diameter >= double{options.min_diameter};
    return points >= kMinOfTree && form.height >= kMinHeight && thick;
}

/// Measures the form of each tree from its own points; removes trees that do not qualify and assigns their
/// points to no tree.
void measure_trees(const PointSet& set, const std::vector<TreeStems>& trees, const PlotOptions& options,
                   double noise, PlotSegments& out, const Context& ctx) {
    const auto points = points_of_trees(set.positions, out.tree_of, trees.size());
    std::vector<StemForm> forms(trees.size());
    parallel_for(ctx, trees.size(), 1, [&](std::size_t t) {
        if (points[t].size() < kMinOfTree) return;
        StemTrack track = trees[t].stems.front();
        const Vec3d foot = track.at(0);
        const HeightOrder order(points[t], {.threads = 1, .stop = ctx.stop, .progress = {}});
        TraceOptions trace{.foot = out.terrain.height(foot.x, foot.y), .noise = noise, .spacing = 0.01};
        trace.top = compute_max_height(order);
        track.raise(trace.foot);
        if (!out.terrain.is_ground) {
            const double above = trace.foot;
            trace.foot = find_base_height(order, track);
            for (StemSection& s : track.sections) s.height += above - trace.foot;
        }
        forms[t] = measure_stem(order, track, trace, set.origin);
        forms[t].on_ground = out.terrain.is_ground;
        forms[t].stems = static_cast<std::uint32_t>(trees[t].stems.size());
    });
    std::vector<std::uint32_t> number(trees.size(), kNoTree);
    for (std::size_t t = 0; t < trees.size(); ++t) {
        if (!is_tree(forms[t], points[t].size(), options)) continue;
        number[t] = static_cast<std::uint32_t>(out.trees.size());
        out.trees.push_back(std::move(forms[t]));
    }
    for (std::uint32_t& t : out.tree_of)
        if (t < number.size()) t = number[t];
}

/// Extends a skeleton to the ground: adds a root below the current one along the axis.
void stand_on_ground(ExtractResult& result, Vec3d foot) {
    const Skeleton& s = result.skeleton;
    const NodeId root(0);
    const Vec3d at = s.origin() + Vec3d(s.position(root));
    const double below = at.z - foot.z;
    if (!(below > 0.1 * double{s.radius(root)})) return;
    std::vector<NodeId> parents{NodeId()};
    std::vector<Vec3> positions{Vec3(foot - s.origin())};
    std::vector<float> radii{s.radius(root)};
    for (const NodeId n : nodes(s)) {
        parents.push_back(s.is_root(n) ? NodeId(0) : NodeId(s.parent(n).index() + 1));
        positions.push_back(s.position(n));
        radii.push_back(s.radius(n));
    }
    result.skeleton = Skeleton(std::move(parents), std::move(positions), std::move(radii), s.origin());
    result.confidence.insert(result.confidence.begin(), NodeConfidence{});
}

void add_warnings(PlotTree& tree) {
    const StemDiameter& breast = tree.form.breast;
    std::vector<std::string> found = tree.figures.doubts;
    if (!(breast.diameter > 0)) {
        found.emplace_back(kNoCircle);
    } else {
        if (breast.coverage < kFewerCoverage) {
            found.push_back(
                fmt::format("only {:.0f} % of the stem is seen at breast height", 100 * breast.coverage));
        }
        if (breast.deviation > kMaxDeviation * breast.diameter)
            found.emplace_back("the diameter at breast height is uncertain");
        if (tree.form.stems > 1) {
            found.push_back(fmt::format("{} stems; the diameter is that of the thickest", tree.form.stems));
        }
    }
    for (std::string& warning : found)
        if (std::ranges::find(tree.warnings, warning) == tree.warnings.end())
            tree.warnings.push_back(std::move(warning));
}

/// Extracts one tree from its points.
void extract_tree(PlotTree& tree, const PointSet& points, CloudOptions options, const Context& ctx) {
    tree.points = points.size();
    options.ground = GroundRule::none;
    options.root = tree.form.foot;
    options.max_trees = 1;
    try {
        CloudExtraction result = extract_from_cloud(points, options, ctx);
        if (result.skeleton.tree_count() == 1) stand_on_ground(result, tree.form.foot);
        SeenStem stem{tree.form.foot, tree.form.breast, tree.form.height};
        tree.figures = std::move(tree_figures(result.skeleton, result.confidence, {&stem, 1}).front());
        tree.crown_base = crown_bases(result.skeleton, {&tree.form, 1}).front();
        tree.result = std::move(result);
    } catch (const InvalidInput& error) {
        tree.warnings.push_back(fmt::format("no skeleton: {}", error.what()));
    }
    tree.crown = measure_crown(points, tree.form.foot.z + tree.crown_base, ctx);
}

}  // namespace

PlotSegments segment_plot(const PointSet& set, const PlotOptions& options, const Context& ctx) {
    check_fields(options, "plot");
    check_points(set);
    PlotSegments out;
    const std::span<const Vec3> points = set.positions;
    out.terrain = find_terrain(points, ctx);
    Buffer<float> height(points.size());
    parallel_for(ctx, points.size(), 16384, [&](std::size_t i) {
        height[i] = static_cast<float>(double{points[i].z} - out.terrain.height(points[i].x, points[i].y));
    });
    ctx.report(kGroundFound);
    const double edge = compute_resolution(set, options, ctx);
    const double noise = stem_noise(0.5 * edge);
    const auto trees = find_trees(points, height, out.terrain, options, noise,
                                  narrow_progress(ctx, kGroundFound, kStemsFound));
    ctx.report(kStemsFound);
    out.tree_of = give_points_to_trees(points, height, out.terrain, trees,
                                       {.voxel = edge, .widest_gap = double{options.widest_gap}},
                                       narrow_progress(ctx, kStemsFound, kPointsGiven));
    measure_trees(set, trees, options, noise, out, ctx);
    ctx.report(1);
    return out;
}

PlotSegments segment_plot_by_ids(const PointSet& set, std::span<const std::uint32_t> tree_ids,
                                 const Context& ctx) {
    check_points(set);
    if (tree_ids.size() != set.size())
        throw InvalidInput(
            fmt::format("extract: there are {} ids of trees for {} points", tree_ids.size(), set.size()));
    PlotSegments out;
    out.terrain = find_terrain(set.positions, ctx);
    ctx.report(kGroundFound);
    std::map<std::uint32_t, std::uint32_t> count;
    for (std::size_t i = 0; i < set.size(); ++i) {
        const Vec3 p = set.positions[i];
        const bool on_ground =
            out.terrain.is_ground && double{p.z} - out.terrain.height(p.x, p.y) < out.terrain.clearance;
        out.tree_of.push_back(on_ground ? kGroundPoint : kNoTree);
        if (!on_ground && tree_ids[i] != 0) ++count[tree_ids[i]];
    }
    std::map<std::uint32_t, std::uint32_t> number;
    for (const auto& [id, points] : count) {
        if (points < kMinOfTree) continue;
        number[id] = static_cast<std::uint32_t>(out.ids.size());
        out.ids.push_back(id);
    }
    for (std::size_t i = 0; i < set.size(); ++i) {
        const auto found = number.find(tree_ids[i]);
        if (out.tree_of[i] == kNoTree && found != number.end()) out.tree_of[i] = found->second;
    }
    auto points = points_of_trees(set.positions, out.tree_of, out.ids.size());
    out.trees.resize(out.ids.size());
    parallel_with_progress(narrow_progress(ctx, kGroundFound, 1), out.trees.size(), 1, [&](IndexRange range) {
        for (std::size_t t = range.begin; t < range.end; ++t) {
            const Context alone{.threads = 1, .stop = ctx.stop, .progress = {}};
            out.trees[t] = stem_form_on(out.terrain, {std::move(points[t]), set.origin}, alone);
        }
    });
    return out;
}

PlotExtraction extract_trees(const PointSet& set, PlotSegments segments, const CloudOptions& tree,
                             const Context& ctx) {
    check_fields(tree, "extract");
    PlotExtraction out{std::move(segments), {}};
    const std::size_t count = out.segments.trees.size();
    auto points = points_of_trees(set.positions, out.segments.tree_of, count);
    out.trees.resize(count);
    const Context alone{.threads = 1, .stop = ctx.stop, .progress = {}};
    parallel_with_progress(ctx, count, 1, [&](IndexRange range) {
        for (std::size_t t = range.begin; t < range.end; ++t) {
            out.trees[t].form = out.segments.trees[t];
            extract_tree(out.trees[t], {std::move(points[t]), set.origin}, tree, alone);
            add_warnings(out.trees[t]);
        }
    });
    return out;
}

PlotExtraction extract_plot(const PointSet& set, const PlotOptions& options, const CloudOptions& tree,
                            const Context& ctx) {
    check_fields(tree, "extract");  // before any work on the points
    return extract_trees(set, segment_plot(set, options, narrow_progress(ctx, 0, kSegmented)), tree,
                         narrow_progress(ctx, kSegmented, 1));
}

void list_fields(PlotOptions& o, FieldList& list) {
    list.add(common_field("min_diameter",
                          "Minimum diameter at breast height of a tree; thinner stems are understorey.",
                          Unit::metre, 0.01, 1),
             o.min_diameter);
    list.add(Field{"max_diameter", "Maximum diameter of a stem.", Unit::metre, 0.05, 20}, o.max_diameter);
    list.add(Field{"resolution",
                   "Edge length of the voxels in which all points belong to one tree; 0 computes it from the "
                   "number of points.",
                   Unit::metre, 0, 1},
             o.resolution);
    list.add(Field{"widest_gap", "Maximum gap between points of one tree.", Unit::metre, 0.01, 10},
             o.widest_gap);
}

}  // namespace coppice
