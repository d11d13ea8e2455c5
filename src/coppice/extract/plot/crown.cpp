#include "coppice/extract/plot/crown.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "coppice/extract/stem/stem_form_internal.h"
#include "coppice/measure/convex_hull.h"
#include "coppice/mesh/shape.h"
#include "coppice/spatial/planar_hull.h"

namespace coppice {
namespace {

constexpr double kLargeBranch = 0.1;  // [height of the tree] minimum length of a large branch

/// Returns per node the length [m] of the longest path beyond it, including the segment to its parent.
std::vector<double> longest_paths(const Skeleton& s) {
    std::vector<double> longest(s.size(), 0.0);
    for (std::uint32_t i = s.size(); i-- > 0;) {
        const NodeId n(i);
        if (s.is_root(n)) continue;
        longest[i] += double{distance(s.position(n), s.position(s.parent(n)))};
        double& above = longest[s.parent(n).index()];
        above = std::max(above, longest[i]);
    }
    return longest;
}

double crown_base(const Skeleton& s, std::span<const NodeId> axis, std::span<const double> longest,
                  const StemForm& form) {
    for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
        for (const NodeId child : s.children(axis[i])) {
            if (child != axis[i + 1] && longest[child.index()] > kLargeBranch * form.height)
                return std::max(0.0, s.origin().z + double{s.position(axis[i]).z} - form.foot.z);
        }
    }
    return form.height;
}

double distance_seen_from_above(Vec3d a, Vec3d b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Returns the convex hull in plan view; empty if it has no area.
std::vector<Vec3d> compute_outline(std::span<const Vec3> points) {
    std::vector<Vec3d> plan;
    for (const Vec3 p : points) plan.emplace_back(p);
    std::vector<Vec3d> hull = compute_planar_hull(std::move(plan));
    if (hull.size() < 3) hull.clear();
    return hull;
}

/// Returns the maximum distance of two corners by rotating calipers: an edge and the corner farthest from it.
double max_width(std::span<const Vec3d> outline) {
    const auto after = [&](std::size_t i) { return (i + 1) % outline.size(); };
    double width = 0;
    std::size_t far = 1;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3d a = outline[i], b = outline[after(i)];
        const auto measure = [&](Vec3d c) {
            width = std::max({width, distance_seen_from_above(a, c), distance_seen_from_above(b, c)});
        };
        measure(b);
        measure(outline[far]);
        while (turn_in_plan(a, b, outline[after(far)]) > turn_in_plan(a, b, outline[far])) {
            far = after(far);
            measure(outline[far]);
        }
    }
    return width;
}

}  // namespace

std::vector<double> crown_bases(const Skeleton& s, std::span<const StemForm> forms) {
    const std::vector<double> longest = longest_paths(s);
    const std::vector<float> reach = extract_internal::highest_below(s);
    std::vector<double> out;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) && out.size() < forms.size())
            out.push_back(
                crown_base(s, extract_internal::main_axis(s, n, reach), longest, forms[out.size()]));
    }
    return out;
}

double Crown::diameter() const { return 2 * std::sqrt(area / std::numbers::pi); }

Crown measure_crown(const PointSet& points, double above, const Context& ctx) {
    std::vector<Vec3> part;
    for (const Vec3 p : points.positions)
        if (points.origin.z + double{p.z} >= above) part.push_back(p);
    Crown out{.outline = compute_outline(part), .hull = convex_hull(part, ctx)};
    out.area = compute_planar_area(out.outline);
    out.max_width = max_width(out.outline);
    for (Vec3d& corner : out.outline)
        corner = {points.origin.x + corner.x, points.origin.y + corner.y, above};
    out.hull.origin = points.origin;
    if (!out.hull.triangles.empty()) {
        const ShapeReport s = shape(to_polygons(out.hull), ctx);
        out.hull_area = s.area;
        out.hull_volume = s.signed_volume;
    }
    return out;
}

std::vector<Crown> measure_crowns(const Skeleton& s, std::span<const double> above, const Context& ctx) {
    std::vector<PointSet> points;
    std::vector<std::uint32_t> tree(s.size());
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) points.push_back({{}, s.origin()});
        tree[n.index()] =
            s.is_root(n) ? static_cast<std::uint32_t>(points.size()) - 1 : tree[s.parent(n).index()];
        points[tree[n.index()]].positions.push_back(s.position(n));
    }
    std::vector<Crown> out;
    for (std::size_t t = 0; t < points.size(); ++t) out.push_back(measure_crown(points[t], above[t], ctx));
    return out;
}

}  // namespace coppice
