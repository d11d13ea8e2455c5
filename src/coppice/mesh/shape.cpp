#include "coppice/mesh/shape.h"

#include <algorithm>
#include <numbers>

#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kShapeGrain = 1 << 14;

struct Extent {
    double volume = 0, area = 0;  // [m^3], [m^2]
};

/// Returns six times the volume of the cones from `apex`, and twice the area, of a range of faces.
Extent extent(const FaceView& mesh, IndexRange range, Vec3d apex) {
    const std::span<const Vec3> positions = mesh.positions();
    Extent e;
    for (std::size_t f = range.begin; f < range.end; ++f) {
        for_each_triangle(mesh.face(static_cast<std::uint32_t>(f)), positions, [&](const Triangle& t) {
            const Vec3d a = Vec3d(positions[t[0]]) - apex, b = Vec3d(positions[t[1]]) - apex,
                        c = Vec3d(positions[t[2]]) - apex;
            e.volume += dot(a, cross(b, c));
            e.area += length(cross(b - a, c - a));
        });
    }
    return e;
}

Extent extent(const FaceView& mesh, const Context& ctx) {
    if (mesh.size() == 0) return {};
    const Vec3d apex(mesh.positions()[0]);
    const Extent sum = parallel_reduce(
        ctx, mesh.size(), kShapeGrain, Extent{}, [&](IndexRange range) { return extent(mesh, range, apex); },
        [](Extent a, Extent b) {
            return Extent{a.volume + b.volume, a.area + b.area};
        });
    return {sum.volume / 6, sum.area / 2};
}

}  // namespace

std::uint32_t fan_corner(std::span<const std::uint32_t> face, std::span<const Vec3> positions) {
    if (face.size() != 4) return 0;
    const auto at = [&](int k) { return Vec3d(positions[face[k]]); };
    return distance(at(0), at(2)) > distance(at(1), at(3)) ? 1 : 0;
}

double scaled_jacobian(std::span<const std::uint32_t> face, std::span<const Vec3> positions) {
    const std::size_t n = face.size();
    const auto at = [&](std::size_t k) { return Vec3d(positions[face[k % n]]); };
    Vec3d normal;
    for (std::size_t k = 1; k + 1 < n; ++k) normal += cross(at(k) - at(0), at(k + 1) - at(0));
    const double size = length(normal);
    double least = 2;
    for (std::size_t k = 0; k < n; ++k) {
        const Vec3d forward = at(k + 1) - at(k), backward = at(k + n - 1) - at(k);
        const double scale = length(forward) * length(backward) * size;
        const double sine = scale > 0 ? dot(cross(forward, backward), normal) / scale : -1;
        least = std::min(least, n == 3 ? sine * 2 / std::numbers::sqrt3 : sine);
    }
    return least;
}

ShapeReport shape(const FaceView& mesh, const Context& ctx) {
    ShapeReport report;
    const std::size_t n = mesh.size();
    if (n == 0) return report;
    std::vector<double> jacobian(n);
    parallel_for(ctx, n, kShapeGrain, [&](std::size_t f) {
        jacobian[f] = scaled_jacobian(mesh.face(static_cast<std::uint32_t>(f)), mesh.positions());
    });
    report.inverted_faces = static_cast<std::uint64_t>(
        std::count_if(jacobian.begin(), jacobian.end(), [](double j) { return j <= 0; }));
    report.scaled_jacobian = statistics(std::move(jacobian));
    const Extent total = extent(mesh, ctx);
    report.signed_volume = total.volume;
    report.area = total.area;
    return report;
}

double signed_volume(const FaceView& mesh, const Context& ctx) { return extent(mesh, ctx).volume; }

}  // namespace coppice
