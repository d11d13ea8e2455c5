#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The state between two rounds of growth; valid only during the call.
struct GrowthSoFar {
    std::uint32_t nodes = 0;             ///< number of nodes
    int rounds = 0;                      ///< number of completed iterations or seasons
    std::string_view limit;              ///< name of the option that limits the number of rounds
    std::function<Skeleton()> skeleton;  ///< creates the current skeleton; O(nodes)
};

/// Called after every round, on the thread that called grow() or sprout(); does not affect the growth.
using GrowthWatch = std::function<void(const GrowthSoFar&)>;

}  // namespace coppice
