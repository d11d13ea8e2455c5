#include "coppice/skeleton/architecture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/skeleton/frustum.h"
#include "coppice/skeleton/measure.h"

namespace coppice {

namespace {

/// Distances of a segment from the root of its tree: at its ends, and the minimum.
struct Span {
    double first, second, nearest;
};

Span find_span(const Segment& s, Vec3d root) {
    const Vec3d a = Vec3d(s.a) - root, b = Vec3d(s.b) - root, along = b - a;
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(-dot(a, along) / square, 0.0, 1.0) : 0.0;
    return {length(a), length(b), length(a + t * along)};
}

}  // namespace

std::vector<std::uint32_t> axis_orders(const Skeleton& s) {
    std::vector<std::uint32_t> order(s.size(), 0);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const NodeId parent = s.parent(n);
        order[n.index()] = order[parent.index()] + (s.leader(parent) == n ? 0 : 1);
    }
    return order;
}

std::vector<BranchOrder> branch_orders(const Skeleton& s) {
    const std::vector<std::uint32_t> order = axis_orders(s);
    return branch_orders(s, order, order);
}

std::vector<BranchOrder> branch_orders(const Skeleton& s, std::span<const std::uint32_t> order,
                                       std::span<const std::uint32_t> axis) {
    COPPICE_ASSERT(order.size() == s.size() && axis.size() == s.size());
    COPPICE_ASSERT(std::ranges::max(order) < s.size());
    std::vector<BranchOrder> out(std::ranges::max(order) + 1);
    for (const NodeId n : nodes(s)) {
        BranchOrder& of_order = out[order[n.index()]];
        const std::uint32_t i = n.index(), p = s.is_root(n) ? i : s.parent(n).index();
        if (i == p || axis[i] != axis[p] || order[i] != order[p]) ++of_order.branches;
        if (i == p) continue;
        const Frustum cone = frustum(s.segment(n));
        of_order.length += cone.length;
        of_order.volume += cone.volume();
    }
    return out;
}

std::vector<std::uint32_t> strahler_orders(const Skeleton& s) {
    std::vector<std::uint32_t> order(s.size(), 0);
    std::vector<bool> is_shared(s.size(),
                                false);  // whether two children have the maximum, which gives the next order
    for (std::uint32_t i = s.size(); i-- > 0;) {
        const NodeId n(i);
        order[i] = std::max(order[i] + (is_shared[i] ? 1u : 0u), 1u);
        if (s.is_root(n)) continue;
        std::uint32_t& above = order[s.parent(n).index()];
        is_shared[s.parent(n).index()] =
            order[i] == above || (order[i] < above && is_shared[s.parent(n).index()]);
        above = std::max(above, order[i]);
    }
    return order;
}

std::vector<DiameterClass> diameter_classes(const Skeleton& s, std::span<const double> limits) {
    std::vector<DiameterClass> classes(limits.size() + 1);
    for (std::size_t k = 0; k < limits.size(); ++k) {
        const double before = k == 0 ? 0 : limits[k - 1];
        if (!(limits[k] > before) || !std::isfinite(limits[k]))
            throw InvalidInput(fmt::format(
                "limits of diameter classes must be above 0 and increase, but {:g} comes after {:g}",
                limits[k], before));
        classes[k].to = classes[k + 1].from = limits[k];
    }
    classes.back().to = std::numeric_limits<double>::infinity();
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Frustum whole = frustum(s.segment(n));
        const double thin = 2 * std::min(whole.radius_a, whole.radius_b);
        const double thick = 2 * std::max(whole.radius_a, whole.radius_b);
        auto k = static_cast<std::size_t>(std::ranges::upper_bound(limits, thin) - limits.begin());
        for (double from = thin;; ++k) {
            const double to = std::min(thick, classes[k].to);
            const double share = thick > thin ? (to - from) / (thick - thin) : 1.0;
            const Frustum part{from / 2, to / 2, whole.length * share};
            classes[k].length += part.length;
            classes[k].area += part.mantle();
            classes[k].volume += part.volume();
            if (to >= thick) break;
            from = to;
        }
    }
    return classes;
}

double ShollProfile::critical_radius() const {
    if (most() == 0) return 0;
    return step * static_cast<double>(std::ranges::max_element(crossings) - crossings.begin() + 1);
}

std::uint64_t ShollProfile::most() const {
    return crossings.empty() ? 0 : *std::ranges::max_element(crossings);
}

ShollProfile sholl(const Skeleton& s, double step) {
    constexpr double kMaxSpheres = 1e6;
    if (!(step >= 0) || !std::isfinite(step))
        throw InvalidInput(fmt::format("the step between spheres is {:g}; it must be 0 or more", step));
    const std::vector<NodeId> roots = tree_roots(s);
    const auto compute_distance = [&](NodeId n) {
        return length(Vec3d(s.position(n)) - Vec3d(s.position(roots[n.index()])));
    };
    double reach = 0;
    for (const NodeId n : nodes(s)) reach = std::max(reach, compute_distance(n));
    if (reach == 0) return {step, {}};
    if (step == 0) step = reach / 100;
    if (reach / step > kMaxSpheres)
        throw InvalidInput(
            fmt::format("a step of {:g} between spheres is too small for a reach of {:g}", step, reach));
    // Changes of the number of crossings from each sphere to the next; the number is their prefix sum.
    std::vector<std::int64_t> change(static_cast<std::size_t>(reach / step) + 2, 0);
    // Adds spheres with radii in (low, high].
    const auto add = [&](double low, double high) {
        const auto first = static_cast<std::size_t>(low / step), last = static_cast<std::size_t>(high / step);
        ++change[first];
        --change[last];
    };
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Span span = find_span(s.segment(n), Vec3d(s.position(roots[n.index()])));
        add(span.nearest, span.first);
        add(span.nearest, span.second);
    }
    ShollProfile out{step, {}};
    std::int64_t sum = 0;
    for (std::size_t k = 0; k + 1 < change.size(); ++k) {
        sum += change[k];
        if (step * static_cast<double>(k + 1) <= reach)
            out.crossings.push_back(static_cast<std::uint64_t>(sum));
    }
    return out;
}

}  // namespace coppice
