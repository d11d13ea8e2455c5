#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/node_join.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A flat end: the surface is cut at the plane dot(normal, p) = offset, and a run of cage quads fills the
/// cut. The border of these quads is the rim, where plane and surface meet.
struct ClipPlane {
    Vec3 normal;                   ///< outward, of any length but 0
    float offset = 0;              ///< [m] times the length of `normal`
    std::uint32_t first_quad = 0;  ///< of the cut
    std::uint32_t quad_count = 0;  ///< of the cut
};

/// What a cage quad is of its tube.
enum class TubePart : std::uint8_t {
    side,   ///< along the tube: corners 0 and 1 lie at its beginning, 2 and 3 where it ends
    start,  ///< closes a tube that begins at a root
    end,    ///< closes a tube at a tip, or is of the ball of a lone node
    fork,   ///< between the tubes at a branch node, which it names in their stead
};

/// A coarse closed cage of quads around a skeleton, with what subdivision and projection need to know about
/// it.
///
/// Every vertex has an anchor: a point inside the solid, on or near the skeleton. Subdivision smooths
/// positions and anchors alike; projection then moves each refined vertex along the ray from its anchor
/// through its position.
struct ControlMesh {
    QuadMesh cage;                      ///< closed, one sphere per tree where there are no joins
    Buffer<Vec3> anchors;               ///< [m] one per cage vertex
    std::vector<std::uint32_t> region;  ///< per quad: the tube it belongs to
    std::vector<TubePart> part;         ///< per quad; those of one part of a tube follow each other
    std::vector<NodeId> region_node;  ///< per region: the skeleton segment (named by its child node) it wraps
    std::vector<ClipPlane> clip;      ///< one per flat end, by first quad
    std::vector<NodeJoin> joins;      ///< tubes that end in branch nodes of others, by `end`
};

}  // namespace coppice
