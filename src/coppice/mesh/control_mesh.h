#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/node_join.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Flat end: the surface is cut at the plane dot(normal, p) = offset, and consecutive cage quads fill the
/// cut. The border of these quads is the rim, the intersection of plane and surface.
struct ClipPlane {
    Vec3 normal;                   ///< outward, of any length except 0
    float offset = 0;              ///< [m] times the length of `normal`
    std::uint32_t first_quad = 0;  ///< first quad of the cut
    std::uint32_t quad_count = 0;  ///< number of quads of the cut
};

/// Portion of a tube that a cage quad belongs to.
enum class TubeFace : std::uint8_t {
    side,   ///< along the tube: corners 0 and 1 are at its start, 2 and 3 at its end
    start,  ///< closes a tube that begins at a root
    end,    ///< closes a tube at a tip, or belongs to the sphere of an isolated node
    fork,   ///< between the tubes at a branch node, which is its region
};

/// Coarse closed cage of quads around a skeleton, with the data required by subdivision and projection.
///
/// Every vertex has an anchor: a point inside the solid, on or near the skeleton. Subdivision smooths both
/// positions and anchors; projection then moves each refined vertex along the ray from its anchor through its
/// position.
struct ControlMesh {
    QuadMesh cage;                      ///< closed, one sphere per tree if there are no joins
    Buffer<Vec3> anchors;               ///< [m] one per cage vertex
    std::vector<std::uint32_t> region;  ///< per quad: its tube
    std::vector<TubeFace> part;         ///< per quad; quads of one portion of a tube are consecutive
    std::vector<NodeId> region_node;    ///< per region: the segment (its child node) that it wraps
    std::vector<ClipPlane> clip;        ///< one per flat end, sorted by first quad
    std::vector<NodeJoin> joins;        ///< tubes that end in branch nodes of others, sorted by `end`
};

}  // namespace coppice
