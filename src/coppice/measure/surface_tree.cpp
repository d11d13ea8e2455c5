#include "coppice/measure/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/parallel.h"
#include "coppice/measure/nearest_triangle_internal.h"
#include "coppice/measure/predicates_internal.h"
#include "coppice/mesh/shape.h"

namespace coppice {
namespace {

constexpr std::size_t kSurfaceTreeGrain = 1 << 13;

TrianglePoints get_points(const PolygonMesh& mesh, const Triangle& t) {
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

}  // namespace

struct SurfaceTree::Collection {
    std::vector<Triangle> triangles;
    std::vector<TriangleRun> runs;
    std::vector<Box3> boxes;

    void add(const PolygonMesh& mesh, std::uint32_t face) {
        bool open = false;
        for_each_triangle(mesh.face(face), mesh.positions, [&](const Triangle& t) {
            const TrianglePoints p = get_points(mesh, t);
            if (is_degenerate(p)) return;
            if (!open) {
                runs.push_back({face, static_cast<std::uint32_t>(triangles.size()), 0});
                boxes.emplace_back();
            }
            triangles.push_back(t);
            for (const Vec3 x : p) boxes.back().extend(x);
            open = ++runs.back().count < 2;
        });
    }

    /// Joins the results of ranges of faces, in their order.
    static Collection join(std::vector<Collection>& ranges) {
        Collection all;
        std::size_t triangle_count = 0, run_count = 0;
        for (const Collection& r : ranges) {
            triangle_count += r.triangles.size();
            run_count += r.runs.size();
        }
        all.triangles.reserve(triangle_count);
        all.runs.reserve(run_count);
        all.boxes.reserve(run_count);
        for (Collection& r : ranges) {
            for (TriangleRun& p : r.runs) p.first += static_cast<std::uint32_t>(all.triangles.size());
            all.triangles.insert(all.triangles.end(), r.triangles.begin(), r.triangles.end());
            all.runs.insert(all.runs.end(), r.runs.begin(), r.runs.end());
            all.boxes.insert(all.boxes.end(), r.boxes.begin(), r.boxes.end());
            r = {};
        }
        return all;
    }

    static Collection of(const PolygonMesh& mesh, const Context& ctx) {
        const std::size_t n = mesh.face_count();
        std::vector<Collection> ranges((n + kSurfaceTreeGrain - 1) / kSurfaceTreeGrain);
        parallel_for_ranges(ctx, n, kSurfaceTreeGrain, [&](IndexRange range) {
            Collection& collection = ranges[range.begin / kSurfaceTreeGrain];
            for (std::size_t f = range.begin; f < range.end; ++f)
                collection.add(mesh, static_cast<std::uint32_t>(f));
        });
        return join(ranges);
    }
};

SurfaceTree::SurfaceTree(const PolygonMesh& mesh, const Context& ctx)
    : SurfaceTree(mesh, Collection::of(mesh, ctx), ctx) {}

SurfaceTree::SurfaceTree(const PolygonMesh& mesh, Collection&& collection, const Context& ctx)
    : mesh_(&mesh),
      triangles_(std::move(collection.triangles)),
      runs_(std::move(collection.runs)),
      boxes_(collection.boxes, ctx) {}

double SurfaceTree::distance(Vec3d p) const {
    double least = std::numeric_limits<double>::infinity();
    const auto bound = [&](std::uint32_t l, std::uint32_t i) {
        return distance_squared(boxes_.level(l)[i], p);
    };
    boxes_.search(bound, least, [&](std::uint32_t item) {
        for (const Triangle& t : triangles(runs_[item])) {
            const TrianglePoints x = get_points(*mesh_, t);
            least = std::min(least, distance_squared(p, Vec3d(x[0]), Vec3d(x[1]), Vec3d(x[2])));
        }
    });
    return std::sqrt(least);
}

bool SurfaceTree::is_within(Vec3d p, double distance) const {
    double limit = distance * distance;
    bool found = false;
    const auto bound = [&](std::uint32_t l, std::uint32_t i) {
        return distance_squared(boxes_.level(l)[i], p);
    };
    boxes_.search(bound, limit, [&](std::uint32_t item) {
        for (const Triangle& t : triangles(runs_[item])) {
            const TrianglePoints x = get_points(*mesh_, t);
            if (found || distance_squared(p, Vec3d(x[0]), Vec3d(x[1]), Vec3d(x[2])) > limit) continue;
            found = true;
            limit = -1;
        }
    });
    return found;
}

double SurfaceTree::signed_distance(Vec3d p) const {
    measure_internal::NearestTriangle nearest(p);
    const auto bound = [&](std::uint32_t l, std::uint32_t i) {
        return distance_squared(boxes_.level(l)[i], p);
    };
    boxes_.search(bound, nearest.limit_squared(), [&](std::uint32_t item) {
        for (const Triangle& t : triangles(runs_[item])) {
            const TrianglePoints x = get_points(*mesh_, t);
            nearest.add(Vec3d(x[0]), Vec3d(x[1]), Vec3d(x[2]));
        }
    });
    return nearest.signed_distance();
}

double distance_squared(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                 d6 = dot(ac, cp);
    if (d1 <= 0 && d2 <= 0) return length_squared(ap);
    if (d3 >= 0 && d4 <= d3) return length_squared(bp);
    if (d6 >= 0 && d5 <= d6) return length_squared(cp);
    // Barycentric coordinates of the closest point, multiplied by a common positive number; one that is not
    // positive selects the nearest edge.
    const double w = d1 * d4 - d3 * d2, v = d5 * d2 - d1 * d6, u = d3 * d6 - d5 * d4;
    if (w <= 0 && d1 >= 0 && d3 <= 0) return length_squared(ap - ab * (d1 / (d1 - d3)));
    if (v <= 0 && d2 >= 0 && d6 <= 0) return length_squared(ap - ac * (d2 / (d2 - d6)));
    if (u <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return length_squared(bp - (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6)));
    }
    return length_squared(ap - (ab * v + ac * w) / (u + v + w));
}

}  // namespace coppice
