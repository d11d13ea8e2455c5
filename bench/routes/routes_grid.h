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

/// A uniform grid around a skeleton.
struct Grid {
    Box3 box;
    float cell = 1;  ///< [m]

    std::uint64_t corners() const;  ///< of the cells in the box
};

/// Returns the grid of the papers: a cube around the surface with this number of corners along each side.
Grid cube_about(const Skeleton& skeleton, std::uint32_t corners);

/// Returns a grid in the smallest box around the surface.
Grid box_about(const Skeleton& skeleton, float cell);

struct GridResult {
    TriMesh surface;
    std::vector<std::pair<std::string, double>> stages;  ///< name, seconds
};

/// Executes marching tetrahedra on a uniform grid, for the same field as mesh_skeleton() uses for round ends,
/// as fast as a uniform grid allows: blocks of 8 x 8 x 8 cells without nearby branches are skipped, and the
/// others have a list of the active segments. Throws Error if a list would be truncated.
GridResult mesh_by_grid(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                        const Context& ctx);

/// Time of the same work with the method of the papers: every segment at every corner.
struct BruteForce {
    double seconds = 0;  ///< for the whole grid
    double share = 1;    ///< share of the grid's blocks, evenly distributed, that were measured
};

/// Measures about as many blocks as `limit` seconds allow.
BruteForce time_brute_force(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                            double limit, const Context& ctx);

}  // namespace coppice::bench
