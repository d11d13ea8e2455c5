#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/hash.h"
#include "coppice/mesh/mesh.h"
#include "tetra/support.h"

namespace coppice {

inline PolygonMesh polygons(const TriMesh& mesh) {
    PolygonMesh out;
    out.positions = mesh.positions;
    for (const Triangle& t : mesh.triangles) out.add_face(t);
    return out;
}

inline double volume(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        sum += volume6({}, Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]),
                       Vec3d(mesh.positions[t[2]]));
    }
    return sum / 6;
}

inline double area(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        sum += length(cross(b - a, c - a)) / 2;
    }
    return sum;
}

/// Returns the minimum angle of every triangle [degrees], ascending.
inline std::vector<double> min_angles(const TriMesh& mesh) {
    std::vector<double> out;
    for (const Triangle& t : mesh.triangles) {
        double least = 180;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d p(mesh.positions[t[i]]), q(mesh.positions[t[(i + 1) % 3]]),
                r(mesh.positions[t[(i + 2) % 3]]);
            const double c = dot(normalized(q - p), normalized(r - p));
            least = std::min(least, std::acos(std::clamp(c, -1.0, 1.0)) * 57.29577951308232);
        }
        out.push_back(least);
    }
    std::ranges::sort(out);
    return out;
}

inline std::uint64_t print(const TriMesh& mesh) {
    return Hash()
        .add(std::span<const Vec3>(mesh.positions))
        .add(std::span<const Triangle>(mesh.triangles))
        .value();
}

/// Returns whether an edge of one triangle intersects the other; triangles that share an edge are ignored.
/// Computed in double precision: coordinates here are small multiples of the float precision.
inline bool edge_meets(Vec3d a, Vec3d b, const std::array<Vec3d, 3>& t) {
    const double da = volume6(t[0], t[1], t[2], a), db = volume6(t[0], t[1], t[2], b);
    if (!((da > 0 && db < 0) || (da < 0 && db > 0))) return false;
    const double s = da > 0 ? 1 : -1;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(s * volume6(a, b, t[i], t[(i + 1) % 3]) < 0)) return false;
    }
    return true;
}

inline std::size_t crossings(const TriMesh& mesh) {
    std::size_t found = 0;
    const auto corners = [&](const Triangle& t) {
        return std::array<Vec3d, 3>{Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]),
                                    Vec3d(mesh.positions[t[2]])};
    };
    std::vector<Box3> boxes(mesh.triangles.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (const std::uint32_t v : mesh.triangles[i]) boxes[i].extend(mesh.positions[v]);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const auto p = corners(mesh.triangles[i]);
        for (std::size_t j = 0; j < boxes.size(); ++j) {
            if (i == j || !boxes[i].overlaps(boxes[j])) continue;
            const Triangle &t = mesh.triangles[i], &u = mesh.triangles[j];
            for (std::size_t e = 0; e < 3; ++e) {
                const std::uint32_t a = u[e], b = u[(e + 1) % 3];
                // An edge that starts in a corner of the triangle meets its plane there.
                if (std::ranges::count(t, a) + std::ranges::count(t, b) > 0) continue;
                found += edge_meets(Vec3d(mesh.positions[a]), Vec3d(mesh.positions[b]), p) ? 1 : 0;
            }
        }
    }
    return found;
}

}  // namespace coppice
