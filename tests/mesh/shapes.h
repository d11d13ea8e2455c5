#pragma once

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/mesh/mesh.h"

namespace coppice::shapes {

inline PolygonMesh polygons(std::vector<Vec3> positions,
                            std::initializer_list<std::initializer_list<std::uint32_t>> faces) {
    PolygonMesh m;
    m.positions.assign(positions.begin(), positions.end());
    for (const auto& f : faces) m.add_face(std::vector(f));
    return m;
}

/// Returns the box from low to high: six quads that face outward.
inline PolygonMesh box(Vec3 low, Vec3 high) {
    std::vector<Vec3> x;
    for (int i = 0; i < 8; ++i) {
        x.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    }
    return polygons(x, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

inline PolygonMesh cube() { return box({0, 0, 0}, {1, 1, 1}); }

/// Returns both meshes in one, with separate vertices.
inline PolygonMesh both(PolygonMesh a, const PolygonMesh& b) {
    const auto shift = static_cast<std::uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (std::uint32_t f = 0; f < b.face_count(); ++f) {
        std::vector<std::uint32_t> face(b.face(f).begin(), b.face(f).end());
        for (auto& v : face) v += shift;
        a.add_face(face);
    }
    return a;
}

/// Returns the mesh with reversed faces.
inline PolygonMesh inverted(const PolygonMesh& m) {
    PolygonMesh out;
    out.positions = m.positions;
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        out.add_face(std::vector<std::uint32_t>(m.face(f).rbegin(), m.face(f).rend()));
    }
    return out;
}

/// Returns a grid of n x m quads; `place(i, j)` is the position of every vertex; closed in i always, in j if
/// `round`.
template <class Place>
PolygonMesh grid(std::uint32_t n, std::uint32_t m, bool round, const Place& place) {
    PolygonMesh out;
    const std::uint32_t rows = round ? m : m + 1;
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) out.positions.push_back(place(i, j));
    }
    for (std::uint32_t j = 0; j < m; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t k = (i + 1) % n, up = (j + 1) % rows;
            out.add_face(std::vector{j * n + i, j * n + k, up * n + k, up * n + i});
        }
    }
    return out;
}

inline float angle(std::uint32_t i, std::uint32_t n) {
    return static_cast<float>(2 * std::numbers::pi * i / n);
}

/// Returns a tube of radius r about z, from 0 to `height`, open at both ends: n quads around, m along.
inline PolygonMesh tube(std::uint32_t n, std::uint32_t m, float r, float height) {
    return grid(n, m, false, [&](std::uint32_t i, std::uint32_t j) {
        const float t = angle(i, n), z = height * static_cast<float>(j) / static_cast<float>(m);
        return Vec3{r * std::cos(t), r * std::sin(t), z};
    });
}

inline PolygonMesh torus(std::uint32_t n, std::uint32_t m, float small, float large) {
    return grid(n, m, true, [&](std::uint32_t i, std::uint32_t j) {
        const float t = angle(i, n), u = -angle(j, m), r = large + small * std::cos(t);
        return Vec3{r * std::cos(u), r * std::sin(u), small * std::sin(t)};
    });
}

/// Returns a Moebius strip of n quads.
inline PolygonMesh moebius(std::uint32_t n) {
    PolygonMesh out;
    for (std::uint32_t i = 0; i < n; ++i) {
        const float t = angle(i, n);
        const Vec3 center{std::cos(t), std::sin(t), 0};
        const Vec3 half = 0.3f * (std::cos(t / 2) * center + Vec3{0, 0, std::sin(t / 2)});
        out.positions.push_back(center - half);
        out.positions.push_back(center + half);
    }
    for (std::uint32_t i = 0; i + 1 < n; ++i)
        out.add_face(std::vector{2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
    out.add_face(std::vector{2 * n - 2, 2 * n - 1, 0u, 1u});
    return out;
}

/// Returns the capsule of radius r about the segment from `low` to `high` on the z axis, closed by triangles
/// at the poles: n quads around, m from pole to equator and m along.
inline PolygonMesh capsule(std::uint32_t n, std::uint32_t m, float r, float low, float high) {
    std::vector<std::pair<float, float>> profile;  // radius, z
    for (std::uint32_t j = 1; j <= m; ++j) {
        const float t = std::numbers::pi_v<float> / 2 * static_cast<float>(j) / static_cast<float>(m);
        profile.emplace_back(r * std::sin(t), low - r * std::cos(t));
    }
    for (std::uint32_t j = 1; j < m; ++j) {
        profile.emplace_back(r, low + (high - low) * static_cast<float>(j) / static_cast<float>(m));
    }
    for (std::uint32_t j = m; j > 0; --j)
        profile.emplace_back(profile[j - 1].first, low + high - profile[j - 1].second);
    const auto last = static_cast<std::uint32_t>(profile.size()) - 1;
    PolygonMesh out = grid(n, last, false, [&](std::uint32_t i, std::uint32_t j) {
        const auto [radius, z] = profile[j];
        return Vec3{radius * std::cos(angle(i, n)), radius * std::sin(angle(i, n)), z};
    });
    const auto pole = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back({0, 0, low - r});
    out.positions.push_back({0, 0, high + r});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t k = (i + 1) % n;
        out.add_face(std::vector{pole, k, i});
        out.add_face(std::vector{pole + 1, last * n + i, last * n + k});
    }
    return out;
}

}  // namespace coppice::shapes
