#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What has grown so far, between two rounds of growth; valid during the call that tells it.
struct GrowthSoFar {
    std::uint32_t nodes = 0;             ///< number of them
    int rounds = 0;                      ///< iterations or seasons that are over
    std::string_view limit;              ///< name of the option that ends growth after so many of them
    std::function<Skeleton()> skeleton;  ///< makes it; O(nodes)
};

/// Told after every round, on the thread that asked for growth, and changes nothing about it.
using GrowthWatch = std::function<void(const GrowthSoFar&)>;

}  // namespace coppice
