#include "coppice/pipeline/repair/grid_corners_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/frame.h"
#include "coppice/base/parallel.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kGrain = 1024;

/// Cylinder coordinates around the axes of a skeleton, in cells of a grid.
class AxisCoordinates {
  public:
    /// `columns`: number of cells around each axis.
    AxisCoordinates(const Skeleton& skeleton, int columns) : columns_(columns), axis_(skeleton.size()) {
        for (const NodeId n : nodes(skeleton)) {
            if (skeleton.is_root(n)) continue;
            const NodeId parent = skeleton.parent(n);
            Axis& axis = axis_[n.index()];
            axis.cone = round_cone<float>(skeleton.segment(n));
            axis.along = normalized(axis.cone.axis);
            if (skeleton.is_root(parent)) {
                axis.side = perpendicular(axis.along);
            } else {
                const Axis& before = axis_[parent.index()];
                axis.side =
                    normalized(Vec3(turned(Vec3d(before.side), Vec3d(before.along), Vec3d(axis.along))));
                axis.start = before.start + cells_along(before.cone, 1);
            }
        }
    }

    /// Returns the closest corner of the grid around the segment of a node. Its lines run along the axis and
    /// around it; across the poles of round ends they are those of a cube on a sphere, which continue the
    /// others.
    GridCorner at(NodeId n, Vec3 p, Vec3 normal) const {
        constexpr float kThinnest = 0.8f, kThickest = 1.25f;  // [radii] range of distances from the axis
        const Axis& axis = axis_[n.index()];
        const auto closest = axis.cone.closest_point(p);
        const float radius =
            std::clamp(length(closest.offset), kThinnest * closest.radius, kThickest * closest.radius);
        const Vec3 other = cross(axis.along, axis.side);
        const float x = dot(closest.offset, axis.side), y = dot(closest.offset, other),
                    z = dot(closest.offset, axis.along);
        if (std::fabs(z) > std::max(std::fabs(x), std::fabs(y))) {
            const float height = std::fabs(z);
            return corner(p, normal, spacing(radius), {axis.side, cells(std::atan2(x, height))},
                          {other, cells(std::atan2(y, height))});
        }
        const float row =
            axis.start + cells_along(axis.cone, closest.t) + cells(std::atan2(z, std::hypot(x, y)));
        return corner(p, normal, spacing(radius), {axis.along, row},
                      {cross(axis.along, closest.offset), cells(std::atan2(y, x))});
    }

  private:
    struct Axis {
        BasicRoundCone<float> cone;
        Vec3 along, side;  // unit, perpendicular to each other
        float start = 0;   // [cells] position along the axis at which the segment begins
    };

    struct Coordinate {
        Vec3 direction;  // in which it increases
        float value;     // [cells]
    };

    // Returns the closest point of the surface at which both coordinates are integers.
    static GridCorner corner(Vec3 p, Vec3 normal, float spacing, const Coordinate& along,
                             const Coordinate& across) {
        const Vec3 tangent =
            normalized(along.direction - normal * dot(along.direction, normal), perpendicular(normal));
        Vec3 other = cross(normal, tangent);
        if (dot(other, across.direction) < 0) other = -other;
        const Vec3 way = tangent * (std::round(along.value) - along.value) +
                         other * (std::round(across.value) - across.value);
        return {p + way * spacing, normal, spacing};
    }

    static Vec3 perpendicular(Vec3 u) {
        const Vec3 other = std::fabs(u.x) < 0.6f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        return normalized(cross(u, other));
    }

    float cells(float angle) const {
        return angle * static_cast<float>(columns_) / (2 * std::numbers::pi_v<float>);
    }
    float spacing(float radius) const {
        return 2 * std::numbers::pi_v<float> * radius / static_cast<float>(columns_);
    }

    // [cells] Returns the length of an axis up to a parameter, in local cells.
    float cells_along(const BasicRoundCone<float>& cone, float t) const {
        const float way = t * length(cone.axis), growth = cone.radius(t) / cone.radius_a - 1;
        const float share = std::fabs(growth) < 1e-4f ? 1 : std::log1p(growth) / growth;
        return way * share / spacing(cone.radius_a);
    }

    int columns_;
    std::vector<Axis> axis_;  // by node
};

std::vector<Vec3> vertex_normals(const TriMesh& mesh) {
    std::vector<Vec3> out(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.positions[t[0]];
        const Vec3 normal = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
        for (const std::uint32_t v : t) out[v] += normal;
    }
    for (Vec3& normal : out) normal = normalized(normal);
    return out;
}

}  // namespace

std::vector<GridCorner> compute_grid_corners(const Marched& marched, const PatchSkeleton& patch_skeleton,
                                             float edge, const Context& ctx) {
    const int columns = std::max(3, static_cast<int>(std::lround(2 * std::numbers::pi_v<float> / edge)));
    const AxisCoordinates coordinates(patch_skeleton.skeleton, columns);
    const TriMesh& mesh = marched.mesh;
    const std::vector<Vec3> normals = vertex_normals(mesh);
    std::vector<GridCorner> out(mesh.positions.size());
    parallel_for(ctx, out.size(), kGrain, [&](std::size_t v) {
        const AxisPoint& axis = marched.closest_axis_point[v];
        const NodeId n = axis.segment ? patch_skeleton.node_at(axis.segment, axis.t) : NodeId::none();
        if (n && !patch_skeleton.skeleton.is_root(n))
            out[v] = coordinates.at(n, mesh.positions[v], normals[v]);
    });
    return out;
}

}  // namespace coppice::pipeline_internal
