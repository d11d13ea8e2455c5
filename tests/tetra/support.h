#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// Returns six times the volume.
inline double volume6(Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return dot(cross(b - a, c - a), d - a); }
inline double volume6(const TetraMesh& mesh, const Tetra& t) {
    return volume6(Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]]),
                   Vec3d(mesh.positions[t[3]]));
}

/// Orients each tetrahedron positively; creates one region for each `per_region` tetrahedra.
inline TetraMesh tetra_mesh(std::span<const Vec3> positions, std::span<const Tetra> tetra,
                            std::size_t per_region = 12) {
    TetraMesh mesh;
    mesh.positions.assign(positions.begin(), positions.end());
    mesh.tetra.assign(tetra.begin(), tetra.end());
    for (Tetra& t : mesh.tetra) {
        if (volume6(mesh, t) < 0) std::swap(t[2], t[3]);
    }
    for (std::size_t t = 0; t < tetra.size(); t += per_region)
        mesh.first.push_back(static_cast<std::uint32_t>(std::min(tetra.size(), t + per_region)));
    return mesh;
}

inline TetraMesh one_tetra() {
    return tetra_mesh(std::array<Vec3, 4>{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}},
                      std::array<Tetra, 1>{Tetra{0, 1, 2, 3}});
}

/// Creates the body-centered cubic lattice in a block of cells of size `cell` from `low`: a tetrahedron for
/// each edge of each face between two cells, if its center satisfies `keep`. One region per cell.
inline TetraMesh bcc_block(std::array<std::uint32_t, 3> cells, float cell, Vec3 low,
                           const std::function<bool(Vec3)>& keep = {}) {
    const std::uint32_t nx = cells[0], ny = cells[1], nz = cells[2];
    TetraMesh mesh;
    const auto corner = [&](std::array<std::uint32_t, 3> c) {
        return (c[2] * (ny + 1) + c[1]) * (nx + 1) + c[0];
    };
    const std::uint32_t corners = (nx + 1) * (ny + 1) * (nz + 1);
    const auto center = [&](std::array<std::uint32_t, 3> c) {
        return corners + (c[2] * ny + c[1]) * nx + c[0];
    };
    std::vector<Vec3> positions;
    const auto at = [&](double x, double y, double z) {
        positions.push_back(Vec3(Vec3d(low) + Vec3d{x, y, z} * double(cell)));
    };
    for (std::uint32_t z = 0; z <= nz; ++z) {
        for (std::uint32_t y = 0; y <= ny; ++y) {
            for (std::uint32_t x = 0; x <= nx; ++x) at(x, y, z);
        }
    }
    for (std::uint32_t z = 0; z < nz; ++z) {
        for (std::uint32_t y = 0; y < ny; ++y) {
            for (std::uint32_t x = 0; x < nx; ++x) at(x + 0.5, y + 0.5, z + 0.5);
        }
    }
    std::vector<std::uint32_t> number(positions.size(), 0xffffffffu);
    const auto add = [&](Tetra t) {
        Vec3 middle;
        for (const std::uint32_t v : t) middle += 0.25f * positions[v];
        if (keep && !keep(middle)) return;
        for (std::uint32_t& v : t) {
            if (number[v] == 0xffffffffu) {
                number[v] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.push_back(positions[v]);
            }
            v = number[v];
        }
        if (volume6(mesh, t) < 0) std::swap(t[2], t[3]);
        mesh.tetra.push_back(t);
    };
    for (std::uint32_t z = 0; z < nz; ++z) {
        for (std::uint32_t y = 0; y < ny; ++y) {
            for (std::uint32_t x = 0; x < nx; ++x) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    std::array<std::uint32_t, 3> c{x, y, z}, other = c;
                    if (++other[axis] == cells[axis]) continue;
                    std::array<std::array<std::uint32_t, 3>, 4> square;
                    square.fill(other);
                    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
                    ++square[1][u], ++square[2][u], ++square[2][v], ++square[3][v];
                    for (std::size_t i = 0; i < 4; ++i)
                        add({center(c), center(other), corner(square[i]), corner(square[(i + 1) % 4])});
                }
                const auto tetra = static_cast<std::uint32_t>(mesh.tetra.size());
                if (tetra > mesh.first.back()) mesh.first.push_back(tetra);
            }
        }
    }
    return mesh;
}

/// Moves every vertex by up to `by` along each axis.
inline TetraMesh bent(TetraMesh mesh, float by, std::uint64_t seed) {
    const CounterRandom random(seed, 1);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        for (int axis = 0; axis < 3; ++axis)
            mesh.positions[v][axis] +=
                static_cast<float>(random.uniform(3 * v + static_cast<std::size_t>(axis), -by, by));
    }
    return mesh;
}

/// Renumbers the vertices in random order.
inline TetraMesh shuffled(const TetraMesh& mesh, std::uint64_t seed) {
    const CounterRandom random(seed, 2);
    std::vector<std::uint32_t> number(mesh.positions.size());
    std::iota(number.begin(), number.end(), 0u);
    std::ranges::sort(number, {}, [&](std::uint32_t v) { return random.bits(v); });
    TetraMesh out = mesh;
    for (std::size_t v = 0; v < number.size(); ++v) out.positions[number[v]] = mesh.positions[v];
    for (Tetra& t : out.tetra) {
        for (std::uint32_t& v : t) v = number[v];
    }
    return out;
}

/// Returns the fine tetrahedra, in one region; vertices by their number.
inline TetraMesh fine_mesh(const TetraRefinement& refinement) {
    TetraMesh out;
    out.positions.resize(refinement.vertex_count());
    for (std::uint32_t t = 0; t < refinement.coarse().tetra.size(); ++t) {
        const TetraPattern& pattern = refinement.pattern(t);
        for (const auto& local : pattern.tetra) {
            Tetra fine{};
            for (std::size_t i = 0; i < 4; ++i) {
                fine[i] = refinement.vertex(t, local[i]);
                out.positions[fine[i]] = refinement.position(t, local[i]);
            }
            if (refinement.mirrored(t)) std::swap(fine[2], fine[3]);
            out.tetra.push_back(fine);
        }
    }
    out.first.push_back(static_cast<std::uint32_t>(out.tetra.size()));
    return out;
}

/// For each face, by its vertices in ascending order: for each side, whether ascending order is
/// counter-clockwise seen from outside the tetrahedron.
using FaceSides = std::map<std::array<std::uint32_t, 3>, std::vector<bool>>;
inline FaceSides face_sides(const TetraMesh& mesh) {
    FaceSides out;
    for (const Tetra& t : mesh.tetra) {
        for (const auto& corners : kTetraFaces) {
            std::array<std::uint32_t, 3> f{t[corners[0]], t[corners[1]], t[corners[2]]};
            std::rotate(f.begin(), std::ranges::min_element(f), f.end());
            const bool turns = f[1] < f[2];
            std::ranges::sort(f);
            out[f].push_back(turns);
        }
    }
    return out;
}

/// Any function of a point as a field; the gradient is computed by differences if the function does not
/// return one.
struct AnyField {
    std::function<float(Vec3)> value;
    float surface = 0;
    float step = 1e-3f;

    float level() const { return surface; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 p = points[i];
            const auto slope = [&](Vec3 d) { return (value(p + d) - value(p - d)) / (2 * step); };
            out[i] = {value(p), {slope({step, 0, 0}), slope({0, step, 0}), slope({0, 0, step})}};
        }
    }
};

/// The compact quartic kernel around a center or an axis, with value 1 at distance `radius`.
struct KernelField {
    Vec3 center;
    float radius = 1;
    Vec3 keep{1, 1, 1};  ///< {1, 1, 0}: around the z axis

    float level() const { return 1; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        constexpr float kReach = 2.25f;  // square of the support
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 p = points[i] - center;
            const Vec3 d{p.x * keep.x / radius, p.y * keep.y / radius, p.z * keep.z / radius};
            const float base = std::max(0.0f, 1 - length_squared(d) / kReach) / (1 - 1 / kReach);
            const float root = std::sqrt(base);
            const float slope = -5 * base * root / (kReach - 1) / radius;
            out[i] = {base * base * root, d * slope};
        }
    }
};

inline KernelField ball_field(Vec3 center, float radius) { return {center, radius, {1, 1, 1}}; }

}  // namespace coppice
