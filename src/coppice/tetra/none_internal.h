#pragma once

#include <cstdint>

namespace coppice::tetra_internal {

/// No vertex, tetrahedron, cell or segment.
inline constexpr std::uint32_t kNone = 0xffffffffu;

}  // namespace coppice::tetra_internal
