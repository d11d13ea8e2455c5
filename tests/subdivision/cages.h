#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A cage to subdivide, as plain vectors.
struct Cage {
    std::vector<Vec3> points;
    std::vector<Quad> quads;

    std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(points.size()); }
};

/// Rings of `sides` corners at the given radius and spacing along z, closed at both ends for 4 sides,
/// otherwise open.
inline Cage tube_cage(int rings, std::uint32_t sides, float radius, float spacing, bool capped) {
    Cage cage;
    for (int r = 0; r < rings; ++r) {
        for (std::uint32_t k = 0; k < sides; ++k) {
            const float angle =
                2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(sides);
            cage.points.push_back(
                {radius * std::cos(angle), radius * std::sin(angle), spacing * static_cast<float>(r)});
        }
    }
    for (std::uint32_t a = 0; a + sides < cage.points.size(); ++a) {
        const std::uint32_t b = a % sides + 1 == sides ? a + 1 - sides : a + 1;
        cage.quads.push_back({a, b, b + sides, a + sides});
    }
    if (capped) {
        const auto top = static_cast<std::uint32_t>(cage.points.size()) - 4;
        cage.quads.push_back({3, 2, 1, 0});
        cage.quads.push_back({top, top + 1, top + 2, top + 3});
    }
    return cage;
}

/// Replaces a quad by a tube of `steps` rings that extends from it.
inline void extrude(Cage& cage, std::size_t face, int steps, Vec3 step) {
    Quad base = cage.quads[face];
    for (int s = 0; s < steps; ++s) {
        Quad top;
        for (std::size_t k = 0; k < 4; ++k) {
            top[k] = cage.vertex_count();
            cage.points.push_back(cage.points[base[k]] + step);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            cage.quads.push_back({base[k], base[(k + 1) % 4], top[(k + 1) % 4], top[k]});
        }
        base = top;
    }
    cage.quads[face] = base;
}

/// A trapezohedron: two poles of valence n, 2 n vertices of valence 3 between them. n = 3 is a cube.
inline Cage hub_cage(std::uint32_t n) {
    Cage cage;
    const std::uint32_t top = 2 * n;
    for (std::uint32_t k = 0; k < 2 * n; ++k) {
        const float angle = std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(n);
        cage.points.push_back({std::cos(angle), std::sin(angle), k % 2 == 0 ? 0.3f : -0.3f});
    }
    cage.points.push_back({0, 0, 1});
    cage.points.push_back({0, 0, -1});
    for (std::uint32_t k = 0; k < 2 * n; k += 2) {
        cage.quads.push_back({top, k, k + 1, (k + 2) % top});
        cage.quads.push_back({top + 1, (k + 3) % top, (k + 2) % top, k + 1});
    }
    return cage;
}

/// columns x rows quads in the plane, or wrapped to a torus.
inline Cage grid_cage(std::uint32_t columns, std::uint32_t rows, bool torus) {
    Cage cage;
    const std::uint32_t width = torus ? columns : columns + 1;
    const std::uint32_t height = torus ? rows : rows + 1;
    for (std::uint32_t j = 0; j < height; ++j) {
        for (std::uint32_t i = 0; i < width; ++i) {
            const float a =
                2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(columns);
            const float b = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(rows);
            const float ring = 3 + std::cos(b);
            cage.points.push_back(torus ? Vec3{ring * std::cos(a), ring * std::sin(a), std::sin(b)}
                                        : Vec3{static_cast<float>(i), static_cast<float>(j), 0});
        }
    }
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t i2 = (i + 1) % width;
            const std::uint32_t j2 = (j + 1) % height;
            cage.quads.push_back({j * width + i, j * width + i2, j2 * width + i2, j2 * width + i});
        }
    }
    return cage;
}

inline Cage branching_cage() {
    Cage cage = tube_cage(7, 4, 1, 1.5f, true);
    extrude(cage, 5, 3, {0.8f, 0.8f, 0.4f});
    extrude(cage, 7, 2, {-0.9f, -0.9f, 0.1f});
    extrude(cage, 14, 2, {-0.7f, 0.7f, 0.9f});
    extrude(cage, 5, 2, {0.9f, -0.2f, 0.5f});
    return cage;
}

/// Moves every point by up to `amount` along each axis, so that no two coincide and no symmetry hides an
/// error.
inline Cage shaken(Cage cage, float amount) {
    const CounterRandom random(7, 1);
    std::uint64_t draw = 0;
    for (Vec3& p : cage.points) {
        for (int axis = 0; axis < 3; ++axis)
            p[axis] += static_cast<float>(random.uniform(draw++, -amount, amount));
    }
    return cage;
}

inline std::vector<std::pair<std::string, Cage>> cage_zoo() {
    std::vector<std::pair<std::string, Cage>> zoo;
    for (const std::uint32_t n : {2u, 3u, 4u, 5u, 6u, 8u})
        zoo.emplace_back("hub " + std::to_string(n), hub_cage(n));
    zoo.emplace_back("one quad", grid_cage(1, 1, false));
    zoo.emplace_back("open grid", grid_cage(4, 3, false));
    zoo.emplace_back("torus", grid_cage(5, 3, true));
    zoo.emplace_back("capped tube", tube_cage(5, 4, 1, 1, true));
    zoo.emplace_back("open tube", tube_cage(4, 6, 1, 1, false));
    zoo.emplace_back("branching", branching_cage());
    for (auto& [name, cage] : zoo) cage = shaken(cage, 0.05f);
    return zoo;
}

}  // namespace coppice
