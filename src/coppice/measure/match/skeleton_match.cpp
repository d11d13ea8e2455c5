#include "coppice/measure/match/skeleton_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/match/match_points_internal.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

constexpr std::size_t kSkeletonMatchGrain = 64;
constexpr std::size_t kBlock = 1 << 13;  // [segments or samples] between two checks of the stop token
// Number of samples of a skeleton: per segment, and additionally for skeletons of few segments.
constexpr double kSamplesPerSegment = 64, kMoreSamples = 1 << 16;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Progress at the end of the stages.
constexpr float kReferenceShare = 0.45f, kFoundShare = 0.9f;

/// Runs body(i) for all i; checks the stop token between blocks.
template <class Body>
void for_blocks(const Context& ctx, std::size_t count, const Body& body) {
    for (std::size_t begin = 0; begin < count; begin += kBlock) {
        ctx.throw_if_cancelled();
        parallel_for(ctx, std::min(kBlock, count - begin), kSkeletonMatchGrain,
                     [&](std::size_t i) { body(begin + i); });
    }
}

/// Returns the limit at which requested numbers, clamped to it, add up to `sum`; infinity if they do not
/// exceed it.
double largest_share(std::vector<double> wanted, double sum) {
    std::ranges::sort(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const double share = sum / static_cast<double>(wanted.size() - i);
        if (wanted[i] > share) return share;
        sum -= wanted[i];
    }
    return kFar;
}

/// Points at even distances along every segment; a segment without length has 0 points.
class Samples {
  public:
    Samples(const CapsuleTree& axes, double step) : first_(axes.size() + 1) {
        const auto wanted = [&](std::uint32_t i) {
            const RoundCone& c = axes.cone(i);
            return length(c.axis) / (step * c.radius(0.5));
        };
        std::vector<double> counts(axes.size());
        for (std::uint32_t i = 0; i < axes.size(); ++i) counts[i] = wanted(i);
        const double most = largest_share(counts, kSamplesPerSegment * axes.size() + kMoreSamples);
        for (std::uint32_t i = 0; i < axes.size(); ++i)
            first_[i + 1] = first_[i] + static_cast<std::uint32_t>(std::ceil(std::min(counts[i], most)));
    }

    std::uint32_t size() const { return first_.back(); }
    std::uint32_t first(std::size_t segment) const { return first_[segment]; }

    /// Calls visit(sample, parameter on the segment); ends early when a stop was requested.
    template <class Visit>
    void for_each(std::size_t segment, const Context& ctx, const Visit& visit) const {
        const std::uint32_t count = first_[segment + 1] - first_[segment];
        for (std::uint32_t k = 0; k < count; ++k) {
            if (k % kSkeletonMatchGrain == 0 && ctx.stop.stop_requested()) return;
            visit(first_[segment] + k, (k + 0.5) / count);
        }
    }

    /// Runs body(segment) for all segments; checks the stop token and reports progress between blocks.
    template <class Body>
    void for_segments(const Context& ctx, float from, float to, const Body& body) const {
        const std::size_t count = first_.size() - 1;
        for (std::size_t begin = 0; begin < count;) {
            std::size_t end = begin + 1;
            while (end < count && end - begin < kBlock && first_[end + 1] - first_[begin] < kBlock) ++end;
            parallel_for(ctx, end - begin, std::max<std::size_t>(1, (end - begin) / kSkeletonMatchGrain),
                         [&](std::size_t i) { body(begin + i); });
            ctx.throw_if_cancelled();
            ctx.report(from + (to - from) * static_cast<float>(end) / static_cast<float>(count));
            begin = end;
        }
    }
    double share(std::size_t segment) const {  ///< of the segment's length, per sample
        return 1.0 / (first_[segment + 1] - first_[segment]);
    }

  private:
    std::vector<std::uint32_t> first_;
};

/// Returns the radius found near a point of the reference; nullopt if the point is not covered.
std::optional<double> adjacent_radius(const CapsuleTree& found, const RoundCone& reference, double t,
                                      double within) {
    const Vec3d p = reference.point(t), direction = normalized(reference.axis);
    const double r = reference.radius(t);
    double limit = within * r * within * r, least = kFar;
    std::uint32_t best = kNoIndex;
    found.visit_near(p, limit, [&](std::uint32_t i, double d2) {
        const RoundCone& c = found.cone(i);
        const double along = dot(c.axis, direction), squared = length_squared(c.axis);
        const double turn = squared > 0 ? 1 - std::min(1.0, along * along / squared) : 1;
        const double cost = d2 + r * r * turn;
        if (cost >= least) return;
        least = cost;
        limit = std::min(limit, cost);
        best = i;
    });
    if (best == kNoIndex) return {};
    const RoundCone& c = found.cone(best);
    return c.closest_point(p).radius;
}

double percent(double part, double all) { return all > 0 ? std::min(100.0, 100 * part / all) : 0; }

double total_length(const CapsuleTree& axes) {
    double sum = 0;
    for (std::uint32_t i = 0; i < axes.size(); ++i) sum += length(axes.cone(i).axis);
    return sum;
}

void judge_reference(const CapsuleTree& reference, const CapsuleTree& found, const CompareOptions& options,
                     const Context& ctx, SkeletonMatch& out) {
    const Samples samples(reference, options.step);
    std::vector<double> error(samples.size(), kUnknown), covered(reference.size());
    samples.for_segments(ctx, 0, kReferenceShare, [&](std::size_t i) {
        const RoundCone& c = reference.cone(static_cast<std::uint32_t>(i));
        std::uint32_t hits = 0;
        samples.for_each(i, ctx, [&](std::uint32_t sample, double t) {
            const auto radius = adjacent_radius(found, c, t, options.within);
            if (!radius) return;
            ++hits;
            error[sample] = *radius / c.radius(t) - 1;
        });
        if (hits > 0) covered[i] = length(c.axis) * hits * samples.share(i);
    });
    double sum = 0;
    for (const double l : covered) sum += l;
    out.covered_percent = percent(sum, total_length(reference));
    std::erase_if(error, [](double e) { return std::isnan(e); });
    out.radius_bias = statistics(error).mean;
    for (double& e : error) e = std::fabs(e);
    out.radius_error = statistics(std::move(error));
}

void judge_found(const CapsuleTree& reference, const CapsuleTree& found, const CompareOptions& options,
                 const Context& ctx, SkeletonMatch& out) {
    if (reference.size() == 0) return;
    const Samples samples(found, options.step);
    struct InsideLength {
        double inside = 0, rho = 0;  // [m] length inside, [m radius] integral of rho
    };
    std::vector<InsideLength> parts(found.size());
    samples.for_segments(ctx, kReferenceShare, kFoundShare, [&](std::size_t i) {
        const RoundCone& c = found.cone(static_cast<std::uint32_t>(i));
        std::uint32_t hint = kNoIndex;
        samples.for_each(i, ctx, [&](std::uint32_t, double t) {
            const CapsuleTree::Nearest nearest = reference.nearest(c.point(t), hint);
            const double l = length(c.axis) * samples.share(i);
            hint = nearest.capsule;
            parts[i].rho += l * nearest.rho;
            if (nearest.rho <= options.within) parts[i].inside += l;
        });
    });
    InsideLength sum;
    for (const InsideLength& p : parts) {
        sum.inside += p.inside;
        sum.rho += p.rho;
    }
    const double all = total_length(found);
    out.true_percent = percent(sum.inside, all);
    out.off_axis = all > 0 ? sum.rho / all : 0;
}

/// A skeleton in the frame of the reference.
struct Placed {
    const Skeleton& skeleton;
    Vec3d shift;
    Vec3d position(NodeId n) const { return Vec3d(skeleton.position(n)) + shift; }
};

/// Fills `metres` and `radii` with distance(p, node) of every node: {in metres, in radii}.
template <class Distance>
void measure_nodes(const Placed& nodes, const Context& ctx, const Distance& distance, Statistics& metres,
                   Statistics& radii) {
    std::vector<double> m(nodes.skeleton.size()), r(nodes.skeleton.size());
    for_blocks(ctx, m.size(), [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        std::tie(m[i], r[i]) = distance(nodes.position(n), n);
    });
    metres = statistics(std::move(m));
    radii = statistics(std::move(r));
}

struct Points {
    std::vector<Vec3d> position;
    std::vector<double> radius;

    void add(const Placed& placed, NodeId n) {
        position.push_back(placed.position(n));
        radius.push_back(placed.skeleton.radius(n));
    }
    std::vector<double> reach(double radii) const {
        std::vector<double> reach = radius;
        for (double& r : reach) r *= radii;
        return reach;
    }
};

/// The nodes that are matched. Roots that are ends follow the tips.
struct Landmarks {
    Points ends, junctions;
    std::size_t tips = 0;

    explicit Landmarks(const Placed& placed) {
        const Skeleton& s = placed.skeleton;
        Points roots;
        for (const NodeId n : nodes(s)) {
            const std::size_t children = s.children(n).size(), all = children + (s.is_root(n) ? 0 : 1);
            if (all >= 3) junctions.add(placed, n);
            if (all == 1) (children == 0 ? ends : roots).add(placed, n);
        }
        tips = ends.position.size();
        ends.position.insert(ends.position.end(), roots.position.begin(), roots.position.end());
        ends.radius.insert(ends.radius.end(), roots.radius.begin(), roots.radius.end());
    }
};

/// Pairs points; only the first `counted_a` and `counted_b` are counted, the others only occupy partners.
NodeMatches match_nodes(const Points& a, std::size_t counted_a, double reach, const Points& b,
                        std::size_t counted_b, const Context& ctx) {
    const auto partner = measure_internal::match_points(a.position, a.reach(reach), b.position, ctx);
    NodeMatches m{.reference = counted_a};
    std::uint64_t taken = 0;  // counted points of b that are matched
    for (std::size_t i = 0; i < partner.size(); ++i) {
        if (partner[i] == kNoIndex) continue;
        if (i < counted_a) ++m.matched;
        if (partner[i] < counted_b) ++taken;
    }
    m.found = m.matched + counted_b - taken;
    return m;
}

void judge_landmarks(const Placed& reference, const Placed& found, const CapsuleTree& axes,
                     const CompareOptions& options, const Context& ctx, SkeletonMatch& out) {
    const Landmarks a(reference), b(found);
    out.tips = match_nodes(a.ends, a.tips, options.tip_reach, b.ends, b.tips, ctx);
    out.junctions = match_nodes(a.junctions, a.junctions.position.size(), options.fork_reach, b.junctions,
                                b.junctions.position.size(), ctx);
    const std::vector<double> reach = a.ends.reach(options.tip_reach);
    std::vector<char> reached(a.tips);
    for_blocks(ctx, a.tips, [&](std::size_t i) {
        reached[i] = axes.axis_distance(a.ends.position[i]) <= reach[i] ? 1 : 0;
    });
    const auto count = static_cast<double>(std::count(reached.begin(), reached.end(), 1));
    out.tips_reached = percent(count, static_cast<double>(a.tips));
}

}  // namespace

SkeletonMatch compare(const Skeleton& reference, const Skeleton& found, const CompareOptions& options,
                      const Context& ctx) {
    check_fields(options, "compare");
    const Vec3d origin = reference.origin();
    const Placed a{reference, {}}, b{found, found.origin() - origin};
    const CapsuleTree axes_a(reference, origin, ctx), axes_b(found, origin, ctx);
    const SkeletonMeasures of_a = measure(reference), of_b = measure(found);

    SkeletonMatch out;
    out.length = {of_a.length, of_b.length};
    out.volume = {of_a.volume, of_b.volume};
    judge_reference(axes_a, axes_b, options, ctx, out);
    judge_found(axes_a, axes_b, options, ctx, out);
    if (axes_b.size() > 0) {
        const auto to_found = [&](Vec3d p, NodeId n) {
            const double d = axes_b.axis_distance(p);
            return std::pair{d, d / reference.radius(n)};
        };
        measure_nodes(a, ctx, to_found, out.reference_nodes_m, out.reference_nodes_r);
    }
    if (axes_a.size() > 0) {
        const auto to_reference = [&](Vec3d p, NodeId) {
            return std::pair{axes_a.axis_distance(p), axes_a.nearest(p).rho};
        };
        measure_nodes(b, ctx, to_reference, out.found_nodes_m, out.found_nodes_r);
    }
    judge_landmarks(a, b, axes_b, options, ctx, out);
    ctx.report(1);
    return out;
}

double unit_ratio(const SkeletonMatch& match, const Skeleton& reference, const Skeleton& found) {
    constexpr double kHardly = 5, kAbout = 0.04;  // [%], and tolerance in decimal logarithms
    if (std::min(match.covered_percent, match.true_percent) > kHardly) return 1;
    const double ratio = double{found.bounds().diagonal()} / reference.bounds().diagonal();
    const double power = std::round(std::log10(ratio));
    return std::fabs(power) < 2 || std::fabs(std::log10(ratio) - power) > kAbout ? 1 : std::pow(10, power);
}

void list_fields(CompareOptions& o, FieldList& list) {
    list.add(Field{"step", "Distance of the samples along an axis.", Unit::radius, 0.01, 100}, o.step);
    list.add(common_field("within", "Maximum distance from an axis at which it counts as covered.",
                          Unit::radius, 1e-3, 100),
             o.within);
    list.add(common_field("tip_reach", "Maximum distance between tips that match.", Unit::radius, 1e-3, 100),
             o.tip_reach);
    list.add(Field{"fork_reach", "Maximum distance between junctions that match.", Unit::radius, 1e-3, 100},
             o.fork_reach);
}

}  // namespace coppice
