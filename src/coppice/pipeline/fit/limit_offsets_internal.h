#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/mesh.h"

namespace coppice::pipeline_internal {

/// Returns the faces by vertex, ascending; a face that has a corner twice is listed twice.
CompressedRows<std::uint32_t> faces_by_vertex(const PolygonMesh& mesh);

/// Returns the normal of a face times its area: exact for triangles, the mean of all triangulations
/// otherwise.
Vec3d area_vector(std::span<const std::uint32_t> face, std::span<const Vec3> positions);

/// Finds the pairs of faces that cross in a surface after its vertices have been moved, up to a limit.
using CrossingSearch =
    std::function<FacePairs(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx)>;

/// Searches all faces.
FacePairs all_crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx);

/// A surface and, per vertex, the direction along which it is to be moved.
struct MovingSurface {
    const PolygonMesh& start;                       ///< positions before
    const CompressedRows<std::uint32_t>& faces_of;  ///< faces by vertex of start
    std::span<const Vec3> direction;                ///< per vertex, unit or shorter
    CrossingSearch search = all_crossings;          ///< replaced by callers with a faster search
};

struct LimitResult {
    std::uint32_t rounds = 0;  ///< number of rounds that reduced offsets
    bool complete = true;      ///< false if there were too many crossings to find: all offsets are then 0
};

/// Reduces offsets until no face folds and no two faces cross that did not before: by half at such faces for
/// the first `halvings` rounds, then to zero, and in their neighbourhood too. Only faces near a change are
/// checked again. O(n log n) for the first check; about 250 bytes of additional memory per face.
LimitResult limit_offsets(const MovingSurface& surface, std::span<float> offsets, std::uint32_t halvings,
                          const Context& ctx);

/// Computes the final positions of the vertices.
void apply_offsets(const MovingSurface& surface, std::span<const float> offsets, Buffer<Vec3>& positions,
                   const Context& ctx);

}  // namespace coppice::pipeline_internal
