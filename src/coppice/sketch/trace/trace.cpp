#include "coppice/sketch/trace/trace.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/skeleton/resample.h"
#include "coppice/sketch/branch_internal.h"
#include "coppice/sketch/draw.h"
#include "coppice/sketch/match_internal.h"
#include "coppice/sketch/trace/hull_internal.h"
#include "coppice/sketch/trace/silhouette_internal.h"

namespace coppice {

using namespace sketch_internal;

namespace {

constexpr double kMaxCost = 1;   // maximum cost of a match per sample
constexpr double kUnlike = 0.1;  // constant dissimilarity, below which differences are not significant
// minimum ratio of the dissimilarity of every competing pair for an unambiguous pair
constexpr double kClear = 1.3;
constexpr double kMinMatched = 0.8;  // minimum matched fraction of the paths from the base to both tips
// [pixels] maximum epipolar distance of two tips, in addition to a fraction of their widths
constexpr double kTipsApart = 2;
constexpr double kTipWidth = 0.2;
constexpr double kMaxError = 4;  // [pixels] maximum distance of a branch from its strokes

/// A view with the lines found in it.
struct Seen {
    Mask mask;
    std::vector<float> distance;
    std::vector<TracedSection> sections;
    std::vector<std::uint32_t> tips;   ///< sections that end in a tip
    std::vector<Line> ways;            ///< by tip: line from the base to it
    std::vector<std::uint32_t> owner;  ///< by section: its branch
    std::vector<char> taken;           ///< by tip: whether a branch ends there

    /// Returns the sections from the base to a section.
    std::vector<std::uint32_t> chain_to(std::uint32_t section) const {
        std::vector<std::uint32_t> out{section};
        while (sections[out.back()].before) out.push_back(*sections[out.back()].before);
        std::ranges::reverse(out);
        return out;
    }
};

/// Two tips that may correspond to each other.
struct TipPair {
    std::array<std::uint32_t, 2> tips;
    double unlike;  ///< dissimilarity of positions and widths
    double rank;    ///< smaller for longer paths and better matches; pairs are processed in ascending order
};

class Tracer {
  public:
    Tracer(const std::vector<SketchView>& views, std::span<const Mask> silhouettes, const Context& ctx)
        : ctx_(ctx) {
        sketch_.views = views;
        for (const SketchView& view : views) views_.push_back(without_distortion(view));
        for (std::size_t v = 0; v < 2; ++v) look(v, silhouettes[v]);
        f_ = fundamental_matrix(views_[0], views_[1]);
    }

    TraceResult run() {
        for (const Seen& seen : seen_) {
            if (seen.tips.empty()) throw InvalidInput("trace: a silhouette is empty");
        }
        // Accepted pairs make others unambiguous: repeat until no pair is accepted.
        const std::vector<TipPair> pairs = tip_pairs();
        for (const std::size_t v : {std::size_t{0}, std::size_t{1}}) {
            pairs_of_[v].resize(seen_[v].tips.size());
            for (std::size_t p = 0; p < pairs.size(); ++p) pairs_of_[v][pairs[p].tips[v]].push_back(p);
        }
        for (bool found = true; found;) {
            const std::size_t before = axes_.size();
            for (const TipPair& pair : pairs) {
                ctx_.throw_if_cancelled();
                if (is_open(pair) && !is_unclear(pair, pairs)) add(pair);
            }
            found = axes_.size() > before;
        }
        if (axes_.empty())
            throw InvalidInput(
                "trace: no branch of the two silhouettes matches; check that the cameras are correct");
        TraceResult out;
        out.sketch = std::move(sketch_);
        for (const Seen& seen : seen_) out.tips.push_back(static_cast<std::uint32_t>(seen.tips.size()));
        return out;
    }

  private:
    void look(std::size_t v, const Mask& silhouette) {
        Seen& seen = seen_[v];
        seen.mask = largest_part(silhouette);
        seen.distance = distance_to_outside(seen.mask);
        seen.sections =
            find_paths(build_graph(thinned(seen.mask, ctx_), seen.distance), seen.mask, seen.distance);
        seen.owner.assign(seen.sections.size(), kNoIndex);
        for (std::uint32_t p = 0; p < seen.sections.size(); ++p) {
            if (!seen.sections[p].is_tip) continue;
            seen.tips.push_back(p);
            const Stroke way = stroke_along(seen.sections, seen.chain_to(p), seen.mask, seen.distance);
            seen.ways.push_back(make_line(sketch_.views[v], way, {}, 1, false));
        }
        seen.taken.assign(seen.tips.size(), 0);
    }

    /// Returns the pairs of tips on each other's epipolar lines with matching paths from the base.
    std::vector<TipPair> tip_pairs() const {
        std::vector<TipPair> out;
        for (std::uint32_t a = 0; a < seen_[0].tips.size(); ++a) {
            ctx_.throw_if_cancelled();
            const Line& first = seen_[0].ways[a];
            for (std::uint32_t b = 0; b < seen_[1].tips.size(); ++b) {
                const Line& second = seen_[1].ways[b];
                const double slack =
                    kTipsApart + kTipWidth * std::max(first.widths.back(), second.widths.back());
                if (epipolar_distance(f_, first.points.back(), second.points.back()) > slack) continue;
                const Match match = match_lines(first, second, f_, true);
                if (match.cost > kMaxCost || match.share < kMinMatched) continue;
                const double unlike = kUnlike + match.cost + unlike_widths(first, second, match);
                out.push_back({{a, b}, unlike, unlike / std::cbrt(first.length() + second.length())});
            }
        }
        std::ranges::stable_sort(out, {}, &TipPair::rank);
        return out;
    }

    bool is_open(const TipPair& pair) const {
        return seen_[0].taken[pair.tips[0]] == 0 && seen_[1].taken[pair.tips[1]] == 0;
    }

    /// Returns whether one of the tips matches another tip nearly as well.
    bool is_unclear(const TipPair& pair, std::span<const TipPair> pairs) const {
        for (const std::size_t v : {std::size_t{0}, std::size_t{1}}) {
            for (const std::size_t p : pairs_of_[v][pair.tips[v]]) {
                const TipPair& other = pairs[p];
                if (other.tips != pair.tips && other.unlike < kClear * pair.unlike && is_open(other))
                    return true;
            }
        }
        return false;
    }

    /// Returns the median absolute logarithm of the ratio of the widths of two paths, relative to its median,
    /// which cancels the scale of the images.
    static double unlike_widths(const Line& first, const Line& second, const Match& match) {
        std::vector<double> ratios;
        for (const Pair& pair : match.pairs)
            ratios.push_back(std::log(first.width_at(pair.s) / second.width_at(pair.t)));
        const double usual = median(ratios);
        for (double& ratio : ratios) ratio = std::abs(ratio - usual);
        return median(ratios);
    }

    /// The section of the path to a tip that does not belong to a branch yet.
    struct Free {
        std::vector<std::uint32_t> chain;  ///< sections without a branch
        std::uint32_t parent = kNoIndex;   ///< branch of the previous section
    };
    Free free_part(const Seen& seen, std::uint32_t tip) const {
        Free out;
        for (const std::uint32_t section : seen.chain_to(seen.tips[tip])) {
            if (seen.owner[section] == kNoIndex) {
                out.chain.push_back(section);
            } else {
                out = {.chain = {}, .parent = seen.owner[section]};
            }
        }
        return out;
    }

    /// Returns whether a branch is another one or a descendant of it.
    bool grows_from(std::uint32_t branch, std::uint32_t other) const {
        for (std::optional<std::uint32_t> at = branch; at; at = sketch_.branches[*at].parent)
            if (*at == other) return true;
        return false;
    }

    /// Adds the branch of the free sections of the paths to two tips, if it can be reconstructed.
    void add(const TipPair& pair) {
        const std::array<Free, 2> free{free_part(seen_[0], pair.tips[0]), free_part(seen_[1], pair.tips[1])};
        if (free[0].chain.empty() || free[1].chain.empty()) return;
        if ((free[0].parent == kNoIndex) != (free[1].parent == kNoIndex)) return;
        SketchBranch branch;
        branch.name = axes_.empty() ? "stem" : "branch " + std::to_string(axes_.size());
        for (const std::uint32_t v : {0u, 1u}) {
            branch.strokes.push_back(
                stroke_along(seen_[v].sections, free[v].chain, seen_[v].mask, seen_[v].distance));
            branch.strokes.back().view = v;
        }
        std::optional<std::uint32_t> parent;
        if (free[0].parent != kNoIndex) {
            // If the fork is hidden in a view, it appears on an ancestor of the parent there.
            const std::uint32_t a = free[0].parent, b = free[1].parent;
            if (!grows_from(a, b) && !grows_from(b, a)) return;
            parent = grows_from(a, b) ? a : b;
        }
        Sketch one{.views = sketch_.views, .branches = {branch}};
        BranchFit fit;
        const SketchOptions options{.noise = 1, .max_error = static_cast<float>(kMaxError)};
        Axis axis = make_axis({one, views_, options, {}}, 0, parent ? &axes_[*parent] : nullptr, fit, ctx_);
        if (axis.positions.empty()) return;
        for (const std::size_t v : {std::size_t{0}, std::size_t{1}}) {
            seen_[v].taken[pair.tips[v]] = 1;
            for (const std::uint32_t section : free[v].chain)
                seen_[v].owner[section] = static_cast<std::uint32_t>(axes_.size());
        }
        branch.parent = parent;
        sketch_.branches.push_back(std::move(branch));
        axes_.push_back(std::move(axis));
    }

    const Context& ctx_;
    Sketch sketch_;
    std::vector<SketchView> views_;  ///< without distortion
    std::array<Seen, 2> seen_;
    std::array<std::vector<std::vector<std::size_t>>, 2> pairs_of_;  ///< by view and tip
    Matrix3 f_{};
    std::vector<Axis> axes_;  ///< by branch
};

}  // namespace

namespace {

constexpr float kTracedTolerance = 0.1f;  // [radius] maximum displacement of the surface by removing nodes
constexpr float kTracedSpacing = 16;      // [pixels] distance between points of a stroke

/// Traces the visual hull of at least three silhouettes, which is a good approximation of the tree.
TraceResult trace_hull(const std::vector<SketchView>& views, std::span<const Mask> silhouettes,
                       const Context& ctx) {
    std::vector<SilhouetteField> fields;
    for (const Mask& mask : silhouettes) fields.emplace_back(mask);
    const Hull hull = compute_hull(views, fields, ctx);
    const std::vector<HullPath> sections = find_paths(hull, ctx);
    const std::vector<RawNode> nodes =
        find_nodes(hull, explaining(hull, sections, views, fields, silhouettes, ctx));
    if (nodes.size() < 2)
        throw InvalidInput("trace: the silhouettes have no common space; check that the cameras are correct");
    const Skeleton skeleton =
        resample(repair(nodes, "trace").skeleton,
                 {.tolerance = kTracedTolerance, .min_spacing = 0, .max_length = 1e6f, .bend_angle = 3.15f})
            .skeleton;
    const auto tips = std::ranges::count_if(sections, &HullPath::is_tip);
    return {draw_sketch(skeleton, views, {.spacing = kTracedSpacing}), {static_cast<std::uint32_t>(tips)}};
}

}  // namespace

Stroke compute_extent(const Mask& silhouette, const std::string& where) {
    const Mask mask = largest_part(silhouette);
    Stroke out;
    for (int y = 0; y < mask.height && out.points.empty(); ++y)
        for (int x = 0; x < mask.width; ++x)
            if (out.points.empty() && mask.at(x, y)) out.points.push_back({x + 0.5, double(y)});
    if (out.points.empty()) throw InvalidInput(where + ": the silhouette is empty");
    for (int y = mask.height - 1; out.points.size() < 2; --y) {
        double sum = 0, count = 0;
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y)) sum += x + 0.5, ++count;
        if (count > 0) out.points.insert(out.points.begin(), {sum / count, y + 1.0});
    }
    return out;
}

TraceResult trace(const std::vector<SketchView>& views, std::span<const Mask> silhouettes,
                  const Context& ctx) {
    if (views.size() < 2 || silhouettes.size() != views.size())
        throw InvalidInput("trace: at least two views with a silhouette each are needed");
    for (std::size_t v = 0; v < views.size(); ++v) {
        validate(views[v], "trace: " + views[v].name);
        const Mask& mask = silhouettes[v];
        if (views[v].width > 0 && (views[v].width != mask.width || views[v].height != mask.height)) {
            throw InvalidInput("trace: the silhouette of '" + views[v].name + "' has " +
                               std::to_string(mask.width) + " x " + std::to_string(mask.height) +
                               " pixels, but the view has " + std::to_string(views[v].width) + " x " +
                               std::to_string(views[v].height));
        }
    }
    if (views.size() > 2) return trace_hull(views, silhouettes, ctx);
    return Tracer(views, silhouettes, ctx).run();
}

}  // namespace coppice
