// Helpers of the tests of measures.
#pragma once

#include "coppice/skeleton/skeleton.h"

namespace coppice {

inline constexpr NodeId kRoot = NodeId::none();  ///< the parent of a root

}  // namespace coppice
