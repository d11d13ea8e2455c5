#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Of closed parts of a surface those that enclose one of these places: 1 by part, of `count`. `part_of`
/// names that of every triangle. Hollows, which are inside out, are named as well, unless they are to go too
/// (`with_hollows`); a part without a triangle counts as one. O(triangles), and O(triangles of the parts
/// about it) for each place.
std::vector<std::uint8_t> enclosing_parts(const TriMesh& mesh, std::span<const std::uint32_t> part_of,
                                          std::size_t count, std::span<const Vec3> places, bool with_hollows,
                                          const Context& ctx = {});

/// Closed parts that were left out.
struct DroppedParts {
    std::uint64_t count = 0;  ///< how many
    /// If there are any: for every vertex before, and one beyond, the number of those kept before it.
    std::vector<std::uint32_t> number;
};

/// Leaves out closed parts of a surface that enclose none of these places, and if wanted hollows, which are
/// inside out. O(triangles), and O(triangles of the parts about it) for each place.
DroppedParts drop_parts(TriMesh& mesh, std::span<const Vec3> places, bool with_hollows,
                        const Context& ctx = {});

}  // namespace coppice
