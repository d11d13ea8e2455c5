#include "coppice/measure/smoothness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/parallel.h"
#include "coppice/measure/forks_internal.h"
#include "coppice/mesh/shape.h"

namespace coppice {
namespace {

using measure_internal::Forks;

constexpr std::size_t kSmoothnessGrain = 1 << 13;
constexpr double kForkReach = 2;  // [radii]
constexpr double kNoAngle = -1;

Vec3d at(const PolygonMesh& mesh, std::uint32_t v) { return Vec3d(mesh.positions[v]); }

// Returns twice the area times the normal.
Vec3d area_vector(const PolygonMesh& mesh, std::uint32_t f) {
    Vec3d sum;
    for_each_triangle(mesh.face(f), mesh.positions, [&](const Triangle& t) {
        const Vec3d a = at(mesh, t[0]);
        sum += cross(at(mesh, t[1]) - a, at(mesh, t[2]) - a);
    });
    return sum;
}

std::vector<Vec3d> vertex_normals(const PolygonMesh& mesh, const std::vector<Vec3d>& areas) {
    std::vector<Vec3d> normals(mesh.positions.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (const std::uint32_t v : mesh.face(f)) normals[v] += areas[f];
    for (Vec3d& n : normals) {
        const double size = length(n);
        if (size > 0) n *= 1 / size;
    }
    return normals;
}

// Returns the integral of the squared gradient of the normals, interpolated linearly on a triangle; 0 for a
// degenerate one.
double bending(const PolygonMesh& mesh, const std::vector<Vec3d>& normals, const Triangle& t) {
    double twice = 0;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t apex = t[k], i = t[(k + 1) % 3], j = t[(k + 2) % 3];
        const Vec3d a = at(mesh, i) - at(mesh, apex), b = at(mesh, j) - at(mesh, apex);
        const double sine = length(cross(a, b));
        if (!(sine > 0)) return 0;
        twice += dot(a, b) / sine * length_squared(normals[i] - normals[j]);
    }
    return std::isfinite(twice) ? 0.5 * twice : 0;
}

// Returns for every face whether its centroid is at a fork.
std::vector<char> faces_at_forks(const PolygonMesh& mesh, const Forks& forks, const Context& ctx) {
    std::vector<char> out(mesh.face_count());
    parallel_for(ctx, out.size(), kSmoothnessGrain, [&](std::size_t f) {
        const auto face = mesh.face(static_cast<std::uint32_t>(f));
        Vec3d sum;
        for (const std::uint32_t v : face) sum += at(mesh, v);
        out[f] = forks.contain(sum / static_cast<double>(face.size())) ? 1 : 0;
    });
    return out;
}

struct Sum {
    double all = 0, forks = 0;
};

Sum bending(const PolygonMesh& mesh, const std::vector<Vec3d>& normals, const std::vector<char>& at_fork,
            const Context& ctx) {
    const auto range_sum = [&](IndexRange range) {
        Sum sum;
        for (std::size_t f = range.begin; f < range.end; ++f) {
            double of_face = 0;
            for_each_triangle(mesh.face(static_cast<std::uint32_t>(f)), mesh.positions,
                              [&](const Triangle& t) { of_face += bending(mesh, normals, t); });
            sum.all += of_face;
            if (!at_fork.empty() && at_fork[f] != 0) sum.forks += of_face;
        }
        return sum;
    };
    return parallel_reduce(ctx, mesh.face_count(), kSmoothnessGrain, Sum{}, range_sum, [](Sum a, Sum b) {
        return Sum{a.all + b.all, a.forks + b.forks};
    });
}

// Returns the angle [degrees] at each edge with two faces, and kNoAngle for other edges.
std::vector<double> face_angles(const HalfEdges& edges, const std::vector<Vec3d>& areas, const Context& ctx) {
    std::vector<double> angles(edges.edge_count(), kNoAngle);
    parallel_for(ctx, angles.size(), kSmoothnessGrain, [&](std::size_t i) {
        const auto halves = edges.halves(static_cast<std::uint32_t>(i));
        if (halves.size() != 2) return;
        const auto [first, second] = std::minmax(halves[0], halves[1]);
        const Vec3d a = areas[edges.face(first)], b = areas[edges.face(second)];
        if (!(length(a) > 0) || !(length(b) > 0)) return;
        angles[i] = std::atan2(length(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
    });
    return angles;
}

// Returns the statistics of the edges with both faces at forks, or with both elsewhere.
Statistics angles_where(const HalfEdges& edges, std::vector<double> angles, const std::vector<char>& at_fork,
                        bool forks) {
    const auto belongs = [&](std::uint32_t h) { return (at_fork[edges.face(h)] != 0) == forks; };
    for (std::uint32_t e = 0; e < angles.size(); ++e) {
        if (!std::ranges::all_of(edges.halves(e), belongs)) angles[e] = kNoAngle;
    }
    std::erase(angles, kNoAngle);
    return statistics(std::move(angles));
}

}  // namespace

SmoothnessReport smoothness(const PolygonMesh& mesh, const HalfEdges& edges, const Skeleton* skeleton,
                            const Context& ctx) {
    std::vector<char> at_fork;
    if (skeleton != nullptr)
        at_fork = faces_at_forks(mesh, Forks(*skeleton, mesh.origin, kForkReach, ctx), ctx);
    std::vector<Vec3d> areas(mesh.face_count());
    parallel_for(ctx, areas.size(), kSmoothnessGrain,
                 [&](std::size_t f) { areas[f] = area_vector(mesh, static_cast<std::uint32_t>(f)); });
    SmoothnessReport report;
    const Sum sum = bending(mesh, vertex_normals(mesh, areas), at_fork, ctx);
    ctx.throw_if_cancelled();
    std::vector<double> angles = face_angles(edges, areas, ctx);
    if (skeleton != nullptr) {
        report.forks = Smoothness{sum.forks, angles_where(edges, angles, at_fork, true)};
        report.chains = Smoothness{sum.all - sum.forks, angles_where(edges, angles, at_fork, false)};
    }
    std::erase(angles, kNoAngle);
    report.whole = {sum.all, statistics(std::move(angles))};
    return report;
}

SmoothnessReport smoothness(const PolygonMesh& mesh, const Skeleton* skeleton, const Context& ctx) {
    return smoothness(mesh, HalfEdges(mesh, ctx), skeleton, ctx);
}

}  // namespace coppice
