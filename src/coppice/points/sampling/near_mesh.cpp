#include "coppice/points/sampling/near_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/random.h"
#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/eliminate_internal.h"

namespace coppice {
namespace {

constexpr std::uint64_t kStage = 0x6d657368;
constexpr std::size_t kCandidates = 4;  // number of candidates per point of an even set
constexpr float kDrawn = 0.1f;          // progress of an even set after drawing the candidates

/// Returns the normal of a triangle with twice its area as length.
Vec3d area_vector(const TriMesh& mesh, const Triangle& t) {
    const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return cross(b - a, c - a);
}

/// Returns the normalized sum of the area vectors around each vertex: an area-weighted normal.
std::vector<Vec3d> vertex_normals(const TriMesh& mesh) {
    std::vector<Vec3d> normals(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3d n = area_vector(mesh, t);
        for (const std::uint32_t v : t) normals[v] += n;
    }
    for (Vec3d& n : normals) n = normalized(n, Vec3d{});
    return normals;
}

/// Draws triangles by the inverse of the cumulative sum of their weights.
class FaceDraw {
  public:
    FaceDraw(const TriMesh& mesh, FaceChoice choice) : sum_(mesh.triangles.size()) {
        for (std::size_t t = 0; t < sum_.size(); ++t) {
            const double area = 0.5 * length(area_vector(mesh, mesh.triangles[t]));
            area_ += area;
            total_ += choice == FaceChoice::by_area ? area : area > 0 ? 1 : 0;
            sum_[t] = total_;
        }
        if (!(total_ > 0) || !std::isfinite(total_)) {
            throw InvalidInput("points: the mesh has no triangle with an area");
        }
    }
    double area() const { return area_; }
    std::size_t find(double share) const {
        const auto above = std::upper_bound(sum_.begin(), sum_.end(), share * total_);
        const auto last = std::lower_bound(sum_.begin(), sum_.end(), total_);  // rounding may exceed it
        return static_cast<std::size_t>(std::min(above, last) - sum_.begin());
    }

  private:
    std::vector<double> sum_;  ///< inclusive sums
    double area_ = 0, total_ = 0;
};

void check(const TriMesh& mesh, const NearMeshOptions& o) {
    check_fields(o, "points");
    if (!(o.low <= o.high)) throw InvalidInput("points: the offset high must not be below low");
    if (o.even && o.choice != FaceChoice::by_area) {
        throw InvalidInput("points: an even set needs triangles chosen by_area");
    }
    const bool finite = std::all_of(mesh.positions.begin(), mesh.positions.end(), [](Vec3 p) {
        return is_finite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1e30f;
    });
    if (!finite) throw InvalidInput("points: a vertex of the mesh is not finite or beyond 1e30");
    const double count = static_cast<double>(o.count) * (o.even ? kCandidates : 1);
    const double meshes = static_cast<double>(mesh.positions.size()) * sizeof(Vec3d) +
                          static_cast<double>(mesh.triangles.size()) * sizeof(double);
    points_internal::check_memory(
        meshes + count * sizeof(Vec3) + (o.even ? points_internal::eliminate_bytes(count) : 0), o.max_memory);
}

/// Returns the distance of the most even set of `count` points: on a thin layer the triangular lattice, in a
/// thick one the densest packing of balls.
double even_distance(double area, double thickness, double count) {
    const double flat = std::sqrt(2 * area / (std::sqrt(3.0) * count));
    const double solid = std::cbrt(std::numbers::sqrt2 * area * thickness / count);
    return std::max(flat, solid);
}

}  // namespace

PointSet near_mesh(const TriMesh& mesh, const NearMeshOptions& options, const Context& ctx) {
    check(mesh, options);
    const FaceDraw faces(mesh, options.choice);
    const std::vector<Vec3d> normals = vertex_normals(mesh);
    const CounterRandom random(static_cast<std::uint64_t>(options.seed), kStage);
    const auto count = static_cast<std::size_t>(options.count);
    PointSet out;
    out.origin = mesh.origin;
    out.positions.resize(count * (options.even ? kCandidates : 1));
    parallel_for(ctx, out.size(), 4096, [&](std::size_t i) {
        const std::uint64_t n = 4 * i;
        const Triangle& t = mesh.triangles[faces.find(random.uniform(n))];
        // The unit square folded along its diagonal.
        double s = random.uniform(n + 1), u = random.uniform(n + 2);
        if (s + u > 1) s = 1 - s, u = 1 - u;
        const auto blend = [&](const auto& of) {
            return Vec3d(of[t[0]]) * (1 - s - u) + Vec3d(of[t[1]]) * s + Vec3d(of[t[2]]) * u;
        };
        const Vec3d normal = normalized(blend(normals), normalized(area_vector(mesh, t)));
        out.positions[i] =
            Vec3(blend(mesh.positions) + normal * random.uniform(n + 3, options.low, options.high));
    });
    if (options.even) {
        ctx.report(kDrawn);
        const double d = even_distance(faces.area(), options.high - options.low, options.count);
        out.positions =
            points_internal::eliminate(out.positions, count, d / 2, narrow_progress(ctx, kDrawn, 1));
    }
    ctx.report(1);
    return out;
}

void list_fields(NearMeshOptions& o, FieldList& list) {
    list.add(Field{"count", "Number of points.", Unit::none, 1, 1e8}, o.count);
    list.add(Field{"low", "Minimum offset along the normal; negative is inside.", Unit::metre, -1e9, 1e9},
             o.low);
    list.add(Field{"high", "Maximum offset along the normal.", Unit::metre, -1e9, 1e9}, o.high);
    list.add(Field{"choice", "Probability of the selection of a triangle."}, o.choice);
    list.add(Field{"even", "Distribute the points evenly."}, o.even);
    list.add(Field{"seed", "Seed of the random points.", Unit::none, 0, 2147483647}, o.seed);
    list.add(Field{"max_memory", "Maximum memory in MiB.", Unit::none, 1, 1e6}, o.max_memory);
}

}  // namespace coppice
