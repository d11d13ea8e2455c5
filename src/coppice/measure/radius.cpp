#include "coppice/measure/radius.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/parallel.h"
#include "coppice/measure/match/area_points_internal.h"

namespace coppice {
namespace {

constexpr double kEndZone = 2;

Statistics deviation_of_areas(const PolygonMesh& mesh, const CapsuleTree& capsules, const Context& ctx) {
    constexpr std::size_t kLeastPoints = 10'000;
    if (mesh.face_count() == 0 || capsules.size() == 0) return {};
    const measure_internal::AreaPoints points(mesh, std::max(kLeastPoints, mesh.positions.size()));
    std::vector<double> deviation(points.size());
    for_each_nearest(
        capsules, ctx, deviation.size(), [&](std::size_t i) { return points[i]; },
        [&](std::size_t i, CapsuleTree::Nearest nearest) { deviation[i] = nearest.rho - 1; });
    return statistics(std::move(deviation));
}

std::vector<char> used_vertices(const PolygonMesh& mesh) {
    std::vector<char> used(mesh.positions.size());
    for (const std::uint32_t v : mesh.corners) used[v] = 1;
    return used;
}

/// What is known of a skeleton's segment beyond its geometry.
struct Ends {
    bool bare_a, bare_b;  ///< away from these the radius is regular: branch nodes, roots, tips
};

std::vector<Ends> ends_of(const Skeleton& skeleton, const CapsuleTree& capsules) {
    std::vector<Ends> ends(capsules.size());
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
        const NodeId b = capsules.node(i), a = skeleton.parent(b);
        const bool branch_a = skeleton.children(a).size() > 1, branch_b = skeleton.children(b).size() > 1;
        ends[i] = {branch_a || skeleton.is_root(a), branch_b || skeleton.is_tip(b)};
    }
    return ends;
}

bool is_regular(const RoundCone& c, const Ends& ends, Vec3d p) {
    const double t = c.line_parameter(p), l = length(c.axis);
    if (!(t > 0 && t < 1)) return false;
    return !(ends.bare_a && t * l < kEndZone * c.radius_a) &&
           !(ends.bare_b && (1 - t) * l < kEndZone * c.radius_b());
}

}  // namespace

RadiusReport radius_deviation(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                              const Context& ctx) {
    const std::size_t n = mesh.positions.size();
    const std::vector<char> used = used_vertices(mesh);
    const std::vector<Ends> ends = ends_of(skeleton, capsules);
    std::vector<CapsuleTree::Nearest> nearest(n);
    for_each_nearest(
        capsules, ctx, n, [&](std::size_t v) { return Vec3d(mesh.positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest found) {
            if (used[v] != 0) nearest[v] = found;
        });
    std::vector<double> all, regular;
    all.reserve(n);
    regular.reserve(n);
    for (std::size_t v = 0; v < n; ++v) {
        const auto [c, rho] = nearest[v];
        if (c == CapsuleTree::kNone) continue;
        all.push_back(rho - 1);
        if (is_regular(capsules.cone(c), ends[c], Vec3d(mesh.positions[v]))) regular.push_back(rho - 1);
    }
    RadiusReport report;
    report.all = statistics(std::move(all));
    report.regular = statistics(std::move(regular));
    report.areas = deviation_of_areas(mesh, capsules, ctx);
    return report;
}

std::vector<float> vertex_deviations(const PolygonMesh& mesh, const Skeleton& skeleton, const Context& ctx) {
    const CapsuleTree capsules(skeleton, mesh.origin, ctx);
    std::vector<float> out(mesh.positions.size());
    for_each_nearest(
        capsules, ctx, out.size(), [&](std::size_t v) { return Vec3d(mesh.positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest found) {
            out[v] = found.capsule != CapsuleTree::kNone ? static_cast<float>(found.rho - 1)
                                                         : std::numeric_limits<float>::quiet_NaN();
        });
    return out;
}

}  // namespace coppice
