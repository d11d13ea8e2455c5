#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/select_internal.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice::lattice_test {

inline std::vector<Segment> collect_segments(const Skeleton& s) {
    std::vector<Segment> out;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            out.push_back(s.segment(n));
        } else if (s.is_tip(n)) {
            out.push_back({s.position(n), s.position(n), s.radius(n), s.radius(n)});
        }
    }
    return out;
}

using SplitKeys = std::vector<Buffer<std::uint64_t>>;

/// Returns random cells to split, with a few deep branches: the first cell and, with a given probability,
/// each child of each split cell.
inline SplitKeys random_splits(unsigned levels, double chance, std::uint64_t seed) {
    const CounterRandom random(seed, 7);
    SplitKeys split{{0}};
    std::uint64_t draws = 0;
    for (unsigned l = 1; l < levels; ++l) {
        Buffer<std::uint64_t> next;
        for (const std::uint64_t key : split.back()) {
            for (std::uint64_t o = 0; o < 8; ++o) {
                if (random.uniform(draws++) < chance) next.push_back(key << 3 | o);
            }
        }
        if (next.empty()) break;
        split.push_back(next);
    }
    return split;
}

/// Creates a cube with a lattice of small integer coordinates, for exact arithmetic: two units per smallest
/// cell.
inline LatticeCube whole_cube(unsigned levels) {
    LatticeCube cube;
    cube.side = std::exp2(levels + 1);
    cube.levels = levels;
    return cube;
}

inline double volume_six(Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return dot(cross(b - a, c - a), d - a); }

inline std::array<Vec3d, 4> get_corners(const TetraMesh& mesh, const Tetra& t) {
    return {Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]]),
            Vec3d(mesh.positions[t[3]])};
}

inline double volume_six(const TetraMesh& mesh, const Tetra& t) {
    const auto [a, b, c, d] = get_corners(mesh, t);
    return volume_six(a, b, c, d);
}

/// Returns whether a tetrahedron contains a point; with `strictly`, whether its interior does.
inline bool contains(const std::array<Vec3d, 4>& corners, Vec3d p, bool strictly = false) {
    for (const auto& f : kTetraFaces) {
        const double side = volume_six(corners[f[0]], corners[f[1]], corners[f[2]], p);
        if (side > 0 || (strictly && side == 0)) return false;
    }
    return true;
}

/// For each face, by its vertices in ascending order: the tetrahedra that have it and whether ascending order
/// is counter-clockwise seen from outside of them.
struct FaceUse {
    TetraFace face;
    bool ascending;
};
using FaceUses = std::map<std::array<std::uint32_t, 3>, std::vector<FaceUse>>;

inline FaceUses face_uses(const TetraMesh& mesh) {
    FaceUses out;
    for (std::uint32_t t = 0; t < mesh.tetra.size(); ++t) {
        for (std::uint32_t opposite = 0; opposite < 4; ++opposite) {
            const auto& corners = kTetraFaces[opposite];
            std::array<std::uint32_t, 3> f{mesh.tetra[t][corners[0]], mesh.tetra[t][corners[1]],
                                           mesh.tetra[t][corners[2]]};
            std::rotate(f.begin(), std::ranges::min_element(f), f.end());
            const bool ascending = f[1] < f[2];
            std::ranges::sort(f);
            out[f].push_back({{t, opposite}, ascending});
        }
    }
    return out;
}

inline std::vector<TetraFace> compute_hull(const FaceUses& uses) {
    std::vector<TetraFace> out;
    for (const auto& [corners, use] : uses) {
        if (use.size() == 1) out.push_back(use[0].face);
    }
    return out;
}

/// Returns the minimum and maximum angle between two faces of a tetrahedron [degrees].
inline std::array<double, 2> dihedral_range(const std::array<Vec3d, 4>& c) {
    std::array<double, 2> range{180, 0};
    std::array<Vec3d, 4> normal;
    for (std::size_t f = 0; f < 4; ++f) {
        const auto& k = kTetraFaces[f];
        normal[f] = normalized(cross(c[k[1]] - c[k[0]], c[k[2]] - c[k[0]]));
    }
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double angle =
                std::acos(std::clamp(-dot(normal[i], normal[j]), -1.0, 1.0)) * 180 / std::numbers::pi;
            range = {std::min(range[0], angle), std::max(range[1], angle)};
        }
    }
    return range;
}

/// The tetrahedra by the positions of their corners, independent of their numbers.
using Corners = std::array<std::array<float, 3>, 4>;
inline std::set<Corners> tetra_set(const TetraMesh& mesh) {
    std::set<Corners> out;
    for (const Tetra& t : mesh.tetra) {
        Corners c;
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 p = mesh.positions[t[i]];
            c[i] = {p.x, p.y, p.z};
        }
        std::ranges::sort(c);
        out.insert(c);
    }
    return out;
}

}  // namespace coppice::lattice_test
