#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// A uniform grid about a skeleton.
struct Grid {
    Box3 box;
    float cell = 1;  ///< [m]

    std::uint64_t corners() const;  ///< of cells in the box
};

/// The papers' grid: a cube about the surface with so many corners along each side.
Grid cube_about(const Skeleton& skeleton, std::uint32_t corners);

/// The smallest box about the surface.
Grid box_about(const Skeleton& skeleton, float cell);

struct GridResult {
    TriMesh surface;
    std::vector<std::pair<std::string, double>> stages;  ///< name, seconds
};

/// Marching tetrahedra on a uniform grid, of the same field as mesh_skeleton() takes for round ends, made as
/// fast as a uniform grid allows: blocks of 8 x 8 x 8 cells that no branch comes near are skipped, and the
/// others have a list of the segments that matter there. Throws Error where such a list would be cut short.
GridResult mesh_by_grid(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                        const Context& ctx);

/// Seconds of the same as the papers do it: every segment at every corner.
struct BruteForce {
    double seconds = 0;  ///< for the whole grid
    double share = 1;    ///< of the grid's blocks, evenly spread, that were measured
};

/// Measures as many blocks as `limit` seconds allow, about.
BruteForce time_brute_force(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                            double limit, const Context& ctx);

}  // namespace coppice::bench
