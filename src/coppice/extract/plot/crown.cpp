#include <algorithm>
#include <cstddef>
#include <vector>

#include "coppice/extract/plot/crown.h"
#include "coppice/extract/stem/stem_form_internal.h"

namespace coppice {
namespace {

constexpr double kLargeBranch = 0.1;  // of the height of the tree

/// Twice the area of the triangle, positive where it turns left.
double turn(Vec3d a, Vec3d b, Vec3d c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

}  // namespace

double crown_base(const Skeleton& s, const StemForm& form) {
    std::vector<double> longest(s.size(), 0.0);  // path below each node, with the segment to its parent
    for (std::uint32_t i = s.size(); i-- > 1;) {
        const NodeId n(i);
        if (s.is_root(n)) continue;
        longest[i] += double{distance(s.position(n), s.position(s.parent(n)))};
        double& above = longest[s.parent(n).index()];
        above = std::max(above, longest[i]);
    }
    const std::vector<NodeId> axis =
        extract_internal::main_axis(s, NodeId(0), extract_internal::highest_below(s));
    for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
        const NodeId n = axis[i];
        for (const NodeId child : s.children(n)) {
            if (child != axis[i + 1] && longest[child.index()] > kLargeBranch * form.height)
                return std::max(0.0, s.origin().z + double{s.position(n).z} - form.foot.z);
        }
    }
    return form.height;
}

double crown_area(const PointSet& points, double above) {
    std::vector<Vec3d> plan;
    for (const Vec3 p : points.positions)
        if (points.origin.z + double{p.z} >= above) plan.emplace_back(p);
    std::ranges::sort(plan, [](Vec3d a, Vec3d b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    if (plan.size() < 3) return 0;
    // Andrew's monotone chain: the lower hull, then the upper one back.
    std::vector<Vec3d> hull;
    const auto add = [&](Vec3d p, std::size_t first) {
        while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
        hull.push_back(p);
    };
    for (const Vec3d p : plan) add(p, 0);
    const std::size_t lower = hull.size() - 1;
    for (auto p = plan.rbegin() + 1; p != plan.rend(); ++p) add(*p, lower);
    double area = 0;
    for (std::size_t i = 1; i + 1 < hull.size(); ++i) area += 0.5 * turn(hull[0], hull[i], hull[i + 1]);
    return area;
}

}  // namespace coppice
