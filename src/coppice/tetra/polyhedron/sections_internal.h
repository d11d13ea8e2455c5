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
    double weight{};  ///< [m^2] of the regular triangulation
    double half{};    ///< [m] half the edge of the square, or what stands for it
};

/// A square across a branch.
struct Section {
    Vec3d center, normal, side;  ///< [m]; unit vectors, `side` to the first corner
    double radius{};             ///< [m] of the branch
    bool is_odd = false;         ///< which two of its corners weigh more: not the same for neighbours
};

/// Squares and points, and how the squares lie along each segment.
struct Sections {
    std::vector<SectionCorner> corners;
    std::vector<Vec3d> side;  ///< per node: of squares across the segment that ends there
    PolyhedronReport report;
};

/// Of [Zhu2013]: a square at each node of a branch, perpendicular to it, others beside forks and beyond ends,
/// and auxiliary points at forks. O(n + pairs of children).
Sections find_sections(const Skeleton& skeleton, const PolyhedronOptions& options);

/// The four corners of a square. Two opposite ones weigh more, so that a box between two squares, of one of
/// which these are those of the other's lighter ones, is cut in five: one about its middle and one at each
/// of the four light corners.
void add_corners(std::vector<SectionCorner>& out, const Section& s, const PolyhedronOptions& options);

}  // namespace coppice::tetra_internal
