#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"
#include "mesh/shapes.h"

namespace coppice::shapes {

struct TubeOptions {
    std::uint32_t sides = 16;
    std::uint32_t rings = 21;  ///< including both ends
    bool closed = true;        ///< whether both ends have a fan
    float radius_end = 0;      ///< [m] 0: as at the start
};

/// Returns a tube of quads about the segment from a to b, faces outward.
inline PolygonMesh tube(Vec3 a, Vec3 b, float radius, const TubeOptions& o = {}) {
    PolygonMesh m;
    const Vec3 w = normalized(b - a), u = perpendicular(w), v = cross(w, u);
    for (std::uint32_t i = 0; i < o.rings; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(o.rings - 1);
        const float r = o.radius_end > 0 ? radius + (o.radius_end - radius) * t : radius;
        for (std::uint32_t k = 0; k < o.sides; ++k) {
            const float angle =
                2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(o.sides);
            m.positions.push_back(lerp(a, b, t) + r * std::cos(angle) * u + r * std::sin(angle) * v);
        }
    }
    for (std::uint32_t i = 0; i + 1 < o.rings; ++i) {
        for (std::uint32_t k = 0; k < o.sides; ++k) {
            const std::uint32_t n = (k + 1) % o.sides, x = i * o.sides, y = x + o.sides;
            m.add_face(std::vector<std::uint32_t>{x + k, x + n, y + n, y + k});
        }
    }
    if (!o.closed) return m;
    const auto low = static_cast<std::uint32_t>(m.positions.size()), top = low - o.sides;
    m.positions.push_back(a);
    m.positions.push_back(b);
    for (std::uint32_t k = 0; k < o.sides; ++k) {
        const std::uint32_t n = (k + 1) % o.sides;
        m.add_face(std::vector<std::uint32_t>{low, n, k});
        m.add_face(std::vector<std::uint32_t>{low + 1, top + k, top + n});
    }
    return m;
}

/// Union of the round cones of a skeleton; every lateral begins with its own radius.
struct CapsuleField {
    const Skeleton& skeleton;

    float level() const { return 0; }
    float distance_to(Vec3 p) const {
        float best = std::numeric_limits<float>::infinity();
        for (const NodeId n : nodes(skeleton)) {
            if (skeleton.is_root(n)) continue;
            const Segment s = skeleton.segment(n);
            const Vec3 d = s.b - s.a;
            const float t = std::clamp(dot(p - s.a, d) / length_squared(d), 0.0f, 1.0f);
            best =
                std::min(best, distance(p, lerp(s.a, s.b, t)) - (s.radius_a + (s.radius_b - s.radius_a) * t));
        }
        return best;
    }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = {-distance_to(points[i]), {}};
    }
};

/// Returns the surface of a skeleton as a closed mesh of irregular triangles.
inline PolygonMesh make_surface(const Skeleton& skeleton, float cell) {
    const CapsuleField field{skeleton};
    return to_polygons(polygonize(FieldRef(field), skeleton.bounds().inflated(2 * cell), {.cell = cell}));
}

/// Returns a trunk of 2 m that forks into two branches of 1.5 m, each at 45 degrees to the trunk.
inline Skeleton fork() {
    const float c = 1.5f * std::numbers::sqrt2_v<float> / 2;
    const NodeId none;
    return Skeleton({none, NodeId(0), NodeId(1), NodeId(1)},
                    {{0, 0, 0}, {0, 0, 2}, {c, 0, 2 + c}, {-c, 0, 2 + c}}, {0.2f, 0.2f, 0.12f, 0.1f});
}

/// Returns a torus about the z axis in the plane z = 0.
inline PolygonMesh torus(float big, float small, std::uint32_t around, std::uint32_t sides) {
    PolygonMesh m;
    const auto angle = [](std::uint32_t i, std::uint32_t n) {
        return 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(n);
    };
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t k = 0; k < sides; ++k) {
            const float r = big + small * std::cos(angle(k, sides));
            m.positions.push_back({r * std::cos(angle(i, around)), r * std::sin(angle(i, around)),
                                   small * std::sin(angle(k, sides))});
        }
    }
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t k = 0; k < sides; ++k) {
            const std::uint32_t x = i * sides, y = (i + 1) % around * sides, n = (k + 1) % sides;
            m.add_face(std::vector<std::uint32_t>{x + k, y + k, y + n, x + n});
        }
    }
    return m;
}

/// Returns the mesh with separate corners for every face.
inline PolygonMesh soup(const PolygonMesh& m) {
    PolygonMesh out;
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        std::vector<std::uint32_t> face;
        for (const std::uint32_t v : m.face(f)) {
            face.push_back(static_cast<std::uint32_t>(out.positions.size()));
            out.positions.push_back(m.positions[v]);
        }
        out.add_face(face);
    }
    return out;
}

/// Returns a square of side 2 h in the plane z = middle.z.
inline PolygonMesh card(Vec3 middle, float h) {
    PolygonMesh m;
    for (const Vec3 d : {Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)})
        m.positions.push_back(middle + d);
    m.add_face(std::vector<std::uint32_t>{0, 1, 2, 3});
    return m;
}

}  // namespace coppice::shapes
