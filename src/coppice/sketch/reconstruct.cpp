#include "coppice/sketch/reconstruct.h"

#include <algorithm>
#include <map>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/resample.h"
#include "coppice/sketch/branch_internal.h"
#include "coppice/sketch/cameras_internal.h"

namespace coppice {

using namespace sketch_internal;

namespace {

// [radius] distance from a node of the parent within which a lateral leaves from that node
constexpr double kSameNode = 0.25;

/// Returns the branches grouped by branch order.
std::vector<std::vector<std::uint32_t>> by_order(const Sketch& sketch) {
    const auto count = static_cast<std::uint32_t>(sketch.branches.size());
    std::vector<std::vector<std::uint32_t>> children(count), orders(1);
    for (std::uint32_t b = 0; b < count; ++b) {
        const auto& parent = sketch.branches[b].parent;
        (parent ? children[*parent] : orders[0]).push_back(b);
    }
    while (true) {
        std::vector<std::uint32_t> next;
        for (const std::uint32_t b : orders.back())
            next.insert(next.end(), children[b].begin(), children[b].end());
        if (next.empty()) return orders;
        orders.push_back(std::move(next));
    }
}

void check_stems(const Sketch& sketch, const std::string& source) {
    for (const SketchBranch& branch : sketch.branches) {
        const auto has_widths = [](const Stroke& stroke) { return !stroke.widths.empty(); };
        if (branch.parent || branch.diameters || std::ranges::any_of(branch.strokes, has_widths)) continue;
        throw InvalidInput(source + ": branch '" + branch.name +
                           "' has no parent and therefore needs widths or diameters");
    }
}

/// Assembles the axes, with a node on the parent axis at the start of each lateral.
class Assembly {
  public:
    Assembly(const Sketch& sketch, const std::vector<Axis>& axes)
        : axes_(axes), laterals_(axes.size()), start_(axes.size(), -1) {
        for (std::uint32_t b = 0; b < axes.size(); ++b)
            if (sketch.branches[b].parent && made(b)) laterals_[*sketch.branches[b].parent].push_back(b);
    }

    std::vector<RawNode> run(const std::vector<std::vector<std::uint32_t>>& orders) {
        for (const auto& order : orders)
            for (const std::uint32_t b : order)
                if (made(b)) add(b);
        return std::move(nodes_);
    }

  private:
    bool made(std::uint32_t b) const { return !axes_[b].positions.empty(); }

    /// Returns the position of a lateral on its parent axis, in nodes from the start; snapped to a node if
    /// one is near.
    static double leaves_at(const Axis& parent, Place place) {
        const Vec3d p = parent.at(place);
        const double near = kSameNode * parent.radius_at(place);
        for (const std::size_t node : {place.node, place.node + 1})
            if (distance(p, parent.positions[node]) < near) return static_cast<double>(node);
        return static_cast<double>(place.node) + place.along;
    }

    void add(std::uint32_t b) {
        const Axis& axis = axes_[b];
        std::map<double, std::int64_t> id_at;
        for (std::size_t i = 0; i < axis.positions.size(); ++i) id_at[static_cast<double>(i)] = -1;
        for (const std::uint32_t lateral : laterals_[b]) id_at[leaves_at(axis, axes_[lateral].start)] = -1;
        std::int64_t last = -1;
        for (auto& [at, id] : id_at) {
            // The first node of a lateral is its node on the parent axis.
            id = last = at == 0 && start_[b] >= 0 ? start_[b] : add_node(last, axis, at);
        }
        for (const std::uint32_t lateral : laterals_[b])
            start_[lateral] = id_at[leaves_at(axis, axes_[lateral].start)];
    }

    std::int64_t add_node(std::int64_t parent, const Axis& axis, double at) {
        const std::size_t node = std::min(static_cast<std::size_t>(at), axis.positions.size() - 2);
        const Place place{node, at - static_cast<double>(node)};
        const auto id = static_cast<std::int64_t>(nodes_.size());
        nodes_.push_back(
            {.id = id, .parent = parent, .position = axis.at(place), .radius = axis.radius_at(place)});
        return id;
    }

    const std::vector<Axis>& axes_;
    std::vector<std::vector<std::uint32_t>> laterals_;  ///< by branch
    std::vector<std::int64_t> start_;                   ///< by lateral: its node on the parent axis
    std::vector<RawNode> nodes_;
};

Skeleton simplified(Skeleton skeleton, float tolerance) {
    if (tolerance == 0) return skeleton;
    return resample(skeleton,
                    {.tolerance = tolerance, .min_spacing = 0, .max_length = 1e6f, .bend_angle = 3.15f})
        .skeleton;
}

}  // namespace

SketchResult reconstruct(const Sketch& sketch, const SketchOptions& options, const std::string& source,
                         const Context& ctx) {
    check_fields(options, "sketch");
    validate(sketch, source);
    check_stems(sketch, source);
    std::vector<SketchView> views;
    for (const SketchView& view : sketch.views) views.push_back(without_distortion(view));
    const Hand hand = estimate_hand(sketch, double{options.noise});
    if (options.refine_cameras) refine_cameras(sketch, views, hand, ctx);
    const SketchFacts facts{sketch, views, options, hand};
    std::vector<BranchFit> fits(sketch.branches.size());
    std::vector<Axis> axes(sketch.branches.size());
    const auto orders = by_order(sketch);
    std::size_t done = 0;
    for (const auto& order : orders) {
        parallel_for(ctx, order.size(), 4, [&](std::size_t i) {
            const std::uint32_t b = order[i];
            const auto& parent = sketch.branches[b].parent;
            fits[b].branch = b;
            axes[b] = make_axis(facts, b, parent ? &axes[*parent] : nullptr, fits[b], ctx);
        });
        done += order.size();
        ctx.report(static_cast<float>(done) / static_cast<float>(sketch.branches.size()));
    }
    const std::vector<RawNode> nodes = Assembly(sketch, axes).run(orders);
    if (nodes.empty()) {
        const auto first = std::ranges::find_if(fits, [](const BranchFit& f) { return !f.refused.empty(); });
        throw InvalidInput(source + ": no branch could be made; " + first->refused);
    }
    return {simplified(repair(nodes, source).skeleton, options.tolerance), std::move(fits)};
}

void list_fields(SketchOptions& o, FieldList& list) {
    list.add(Field{"noise", "Standard deviation of drawn points in pixels; 0 measures it along each stroke.",
                   Unit::none, 0, 100},
             o.noise);
    list.add(Field{"bend", "Standard turn of a branch from start to tip; smaller values are smoother.",
                   Unit::radian, 0.01, 10},
             o.bend);
    list.add(common_field("max_error",
                          "Maximum distance in pixels of a branch from its strokes, as root mean square.",
                          Unit::none, 0.1, 1000),
             o.max_error);
    list.add(Field{"min_angle", "Minimum angle between views; strokes in closer views are refused.",
                   Unit::radian, 1e-3, 1.5},
             o.min_angle);
    list.add(Field{"tolerance", "Maximum displacement of the surface by removing nodes; 0 keeps all nodes.",
                   Unit::radius, 0, 1},
             o.tolerance);
    list.add(Field{"refine_cameras",
                   "Adjust cameras slightly until starts and tips are on each other's lines of sight."},
             o.refine_cameras);
}

}  // namespace coppice
