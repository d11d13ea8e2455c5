#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/mesh.h"

namespace coppice::pipeline_internal {

/// Faces by vertex, ascending; a face with a corner twice is there twice.
CompressedRows<std::uint32_t> faces_by_vertex(const PolygonMesh& mesh);

/// Normal of a face times its area: exact for triangles, the mean of all triangulations otherwise.
Vec3d area_vector(std::span<const std::uint32_t> face, std::span<const Vec3> positions);

/// Finds the pairs of faces that cross in a surface whose vertices have been moved, up to a limit.
using CrossingSearch =
    std::function<FacePairs(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx)>;

/// Searches all faces.
FacePairs all_crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx);

/// A surface whose vertices are about to move, each along a direction of its own.
struct MovingSurface {
    const PolygonMesh& start;                       ///< before
    const CompressedRows<std::uint32_t>& faces_of;  ///< of start
    std::span<const Vec3> direction;                ///< per vertex, unit or shorter
    CrossingSearch search = all_crossings;          ///< for who knows where to look
};

struct LimitResult {
    std::uint32_t rounds = 0;  ///< of taking back
    bool complete = true;      ///< false where there were too many crossings to find: all is taken back
};

/// Takes offsets back until no face folds and no two faces cross that did not before: at such faces by half
/// for the first `halvings` rounds, then wholly and about them too. Only what is near a change is looked at
/// again. O(n log n) for the first look; about 250 bytes per face meanwhile.
LimitResult limit_offsets(const MovingSurface& surface, std::span<float> offsets, std::uint32_t halvings,
                          const Context& ctx);

/// Where the vertices lie after all.
void apply_offsets(const MovingSurface& surface, std::span<const float> offsets, Buffer<Vec3>& positions,
                   const Context& ctx);

}  // namespace coppice::pipeline_internal
