#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Surfaces stop at a clip plane: points with dot(normal, p) > offset are cut away. A zero normal cuts
/// nothing.
struct ClipPlane {
    Vec3 normal;
    float offset = 0;
};

/// A coarse closed cage of quads around a skeleton, with what subdivision and projection need to know about
/// it.
///
/// Every vertex has an anchor: a point inside the solid, on or near the skeleton. Subdivision smooths
/// positions and anchors alike; projection then moves each refined vertex along the ray from its anchor
/// through its position.
struct ControlMesh {
    QuadMesh cage;
    Buffer<Vec3> anchors;               ///< [m] one per cage vertex
    std::vector<std::uint32_t> region;  ///< per quad: the tube it belongs to
    std::vector<NodeId> region_node;  ///< per region: the skeleton segment (named by its lower node) it wraps
    std::vector<ClipPlane> clip;      ///< per region: where a flat end cuts the surface
};

}  // namespace coppice
