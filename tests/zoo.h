#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Small skeletons that have every difficulty a mesher meets: each is valid, none is repaired. Tests loop
/// over all of them. Names are snake_case and stay the same, so that a test may single one out. Each fixed
/// bug leaves its input here.
std::vector<std::pair<std::string, Skeleton>> skeleton_zoo();

/// The one of that name; throws std::out_of_range when there is none.
Skeleton zoo_skeleton(const std::string& name);

}  // namespace coppice
