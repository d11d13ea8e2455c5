#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/polyhedron/polyhedron.h"

namespace coppice::tetra_internal {

/// A corner of the polyhedron.
struct SectionCorner {
    Vec3d at;         ///< [m]
    double weight{};  ///< [m^2] weight in the regular triangulation
    double half{};    ///< [m] half the edge of the square, or an equivalent length
};

/// A square across a branch.
struct Section {
    Vec3d center, normal, side;  ///< [m]; unit vectors, `side` points to the first corner
    double radius{};             ///< [m] of the branch
    bool is_odd = false;         ///< which two of its corners weigh more; alternates between neighbours
};

/// Squares, points, and the orientation of the squares along each segment.
struct Sections {
    std::vector<SectionCorner> corners;
    std::vector<Vec3d>
        side;  ///< per node: direction of the first corner of the squares across the segment that ends there
    PolyhedronReport report;
};

/// Computes the cross-sections of [Zhu2013]: a square at each node of a branch, perpendicular to it, further
/// squares near forks and beyond ends, and auxiliary points at forks. O(n + pairs of children).
Sections find_sections(const Skeleton& skeleton, const PolyhedronOptions& options);

/// Appends the four corners of a square. Two opposite corners have a larger weight. In the next square the
/// other two corners have it, so that the box between the two squares is cut into five tetrahedra: one in its
/// middle and one at each of the four light corners.
void add_corners(std::vector<SectionCorner>& out, const Section& s, const PolyhedronOptions& options);

}  // namespace coppice::tetra_internal
