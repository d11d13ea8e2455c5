#pragma once

#include <cstdint>

namespace coppice::extract_internal {

/// No point, vertex or node of a draft.
inline constexpr std::uint32_t kNone = 0xffffffffu;

}  // namespace coppice::extract_internal
