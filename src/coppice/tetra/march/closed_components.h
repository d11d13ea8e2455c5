#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns for each of `count` closed components of a surface whether it encloses one of these points (1) or
/// not (0). `component_of` is the component of every triangle. Hollows, which are inside out, are also 1,
/// unless `with_hollows` requests their removal; a component without a triangle counts as a hollow.
/// O(triangles), plus O(triangles of the components around it) for each point.
std::vector<std::uint8_t> enclosing_components(const TriMesh& mesh,
                                               std::span<const std::uint32_t> component_of, std::size_t count,
                                               std::span<const Vec3> places, bool with_hollows,
                                               const Context& ctx = {});

/// Closed components that were removed.
struct RemovedComponents {
    std::uint64_t count = 0;  ///< number of removed components
    /// Empty if there are none: for every old vertex, and one past the end, the number of kept vertices
    /// before it.
    std::vector<std::uint32_t> number;
};

/// Removes closed components of a surface that enclose none of these points, and with `with_hollows` also
/// hollows, which are inside out. O(triangles), plus O(triangles of the components around it) for each point.
RemovedComponents drop_parts(TriMesh& mesh, std::span<const Vec3> places, bool with_hollows,
                             const Context& ctx = {});

}  // namespace coppice
