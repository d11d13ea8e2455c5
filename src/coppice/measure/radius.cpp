#include "coppice/measure/radius.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/match/area_points_internal.h"

namespace coppice {
namespace {

Statistics deviation_of_areas(const PolygonMesh& mesh, const CapsuleTree& capsules, const Context& ctx) {
    constexpr std::size_t kMinPoints = 10'000;
    if (mesh.face_count() == 0 || capsules.size() == 0) return {};
    const measure_internal::AreaPoints points(mesh, std::max(kMinPoints, mesh.positions.size()));
    std::vector<double> deviation(points.size());
    for_each_nearest(
        capsules, ctx, deviation.size(), [&](std::size_t i) { return points[i]; },
        [&](std::size_t i, CapsuleTree::Nearest nearest) { deviation[i] = nearest.rho - 1; });
    return statistics(std::move(deviation));
}

}  // namespace

RadiusReport radius_deviation(const PolygonMesh& mesh, const CapsuleTree& capsules,
                              const VertexPlaces& places, const Context& ctx) {
    const std::size_t n = mesh.positions.size();
    std::vector<double> all, regular;
    all.reserve(n);
    regular.reserve(n);
    for (std::size_t v = 0; v < n; ++v) {
        const auto [c, rho] = places.nearest[v];
        if (c == kNoIndex) continue;
        all.push_back(rho - 1);
        if (places.is_regular[v] != 0) regular.push_back(rho - 1);
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
            out[v] = found.capsule != kNoIndex ? static_cast<float>(found.rho - 1)
                                               : std::numeric_limits<float>::quiet_NaN();
        });
    return out;
}

}  // namespace coppice
