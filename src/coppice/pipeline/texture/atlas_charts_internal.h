#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/mesh/texture.h"
#include "coppice/pipeline/texture/atlas_faces_internal.h"

namespace coppice::pipeline_internal {

/// Charts of a surface in metres.
struct AtlasCharts {
    std::vector<Chart> charts;    ///< each face belongs to one
    Buffer<PlanePoint> points;    ///< [m] per corner of the faces, in the plane of the chart
    std::uint64_t projected = 0;  ///< faces in charts that are projected on a plane
};

/// Divides a surface into charts by its bark coordinates: connected faces with continuous coordinates are
/// unrolled, with the width of the tube at each place, and cut across where they are longer than
/// `max_length` [m] or their width has halved. Faces without such coordinates, or that would be stretched,
/// form charts with similar normals, each projected on a plane. O(n log n).
AtlasCharts make_charts(const AtlasFaces& faces, std::span<const TexturePoint> bark, float max_length,
                        const Context& ctx);

/// Sets the points of a face to those on its own plane.
void flatten_face(const AtlasFaces& faces, std::uint32_t face, std::span<PlanePoint> points);

}  // namespace coppice::pipeline_internal
