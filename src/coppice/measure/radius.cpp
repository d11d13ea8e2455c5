#include "coppice/measure/radius.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/parallel.h"
#include "coppice/measure/match/area_points_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kRadiusGrain = 1 << 12;
constexpr double kEndZone = 2;
constexpr double kFree = 1.3;
constexpr double kMissing = 1.8;
constexpr double kPinched = 0.3;

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
    bool tip;
};

std::vector<Ends> ends_of(const Skeleton& skeleton, const CapsuleTree& capsules) {
    std::vector<Ends> ends(capsules.size());
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
        const NodeId b = capsules.node(i), a = skeleton.parent(b);
        const bool branch_a = skeleton.children(a).size() > 1, branch_b = skeleton.children(b).size() > 1;
        const bool tip = skeleton.is_tip(b);
        ends[i] = {branch_a || skeleton.is_root(a), branch_b || tip, tip};
    }
    return ends;
}

bool is_regular(const RoundCone& c, const Ends& ends, Vec3d p) {
    const double t = c.line_parameter(p), l = length(c.axis);
    if (!(t > 0 && t < 1)) return false;
    return !(ends.bare_a && t * l < kEndZone * c.radius_a) &&
           !(ends.bare_b && (1 - t) * l < kEndZone * c.radius_b());
}

double reach_beyond(const RoundCone& c, Vec3d p) {
    return dot(p - c.b(), c.axis) / std::max(1e-30, length(c.axis)) / c.radius_b();
}

Statistics tip_reach(const PolygonMesh& mesh, const CapsuleTree& capsules, std::span<const Ends> ends,
                     std::span<const CapsuleTree::Nearest> nearest) {
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    std::vector<double> reach(capsules.size(), kNone);
    for (std::size_t v = 0; v < nearest.size(); ++v) {
        const std::uint32_t c = nearest[v].capsule;
        if (c == CapsuleTree::kNone || !ends[c].tip) continue;
        reach[c] = std::max(reach[c], reach_beyond(capsules.cone(c), Vec3d(mesh.positions[v])));
    }
    std::erase(reach, kNone);
    return statistics(std::move(reach));
}

}  // namespace

RadiusReport radius_deviation(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                              const Context& ctx) {
    const std::size_t n = mesh.positions.size();
    const std::vector<char> used = used_vertices(mesh);
    const std::vector<Ends> ends = ends_of(skeleton, capsules);
    std::vector<CapsuleTree::Nearest> nearest(n);
    parallel_for_ranges(ctx, n, kRadiusGrain, [&](IndexRange range) {
        // Vertices that follow each other mostly lie near each other.
        std::uint32_t hint = CapsuleTree::kNone;
        for (std::size_t v = range.begin; v < range.end; ++v) {
            if (!used[v]) continue;
            nearest[v] = capsules.nearest(Vec3d(mesh.positions[v]), hint);
            hint = nearest[v].capsule;
        }
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
    report.tip_reach = tip_reach(mesh, capsules, ends, nearest);
    report.tips =
        static_cast<std::uint64_t>(std::count_if(ends.begin(), ends.end(), [](Ends e) { return e.tip; }));
    report.all = statistics(std::move(all));
    report.regular = statistics(std::move(regular));
    report.areas = deviation_of_areas(mesh, capsules, ctx);
    return report;
}

std::vector<float> vertex_deviations(const PolygonMesh& mesh, const Skeleton& skeleton, const Context& ctx) {
    const CapsuleTree capsules(skeleton, mesh.origin, ctx);
    std::vector<float> out(mesh.positions.size());
    parallel_for_ranges(ctx, out.size(), kRadiusGrain, [&](IndexRange range) {
        std::uint32_t hint = CapsuleTree::kNone;
        for (std::size_t v = range.begin; v < range.end; ++v) {
            const auto nearest = capsules.nearest(Vec3d(mesh.positions[v]), hint);
            const bool found = nearest.capsule != CapsuleTree::kNone;
            hint = nearest.capsule;
            out[v] = found ? static_cast<float>(nearest.rho - 1) : std::numeric_limits<float>::quiet_NaN();
        }
    });
    return out;
}

CoverageReport coverage(const SurfaceTree& surface, const CapsuleTree& capsules, const Context& ctx) {
    constexpr double kNotFree = -1;
    std::vector<double> gap(capsules.size());
    parallel_for(ctx, gap.size(), 64, [&](std::size_t i) {
        const RoundCone& c = capsules.cone(static_cast<std::uint32_t>(i));
        const Vec3d middle = c.point(0.5);
        const bool free = !capsules.any_within(middle, kFree, static_cast<std::uint32_t>(i));
        gap[i] = free ? surface.distance(middle) / c.radius(0.5) : kNotFree;
    });
    std::erase(gap, kNotFree);
    const auto count = [&](auto is) {
        return static_cast<std::uint64_t>(std::count_if(gap.begin(), gap.end(), is));
    };
    CoverageReport report;
    report.judged = gap.size();
    report.missing = count([](double g) { return g > kMissing; });
    report.pinched = count([](double g) { return g < kPinched; });
    std::erase_if(gap, [](double g) { return std::isinf(g); });
    for (double& g : gap) g -= 1;
    report.middle_to_surface = statistics(std::move(gap));
    return report;
}

}  // namespace coppice
