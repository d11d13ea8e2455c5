#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Small skeletons with every difficulty for a mesher: each is valid, and requires no repair. Tests loop over
/// all of them. Names are snake_case and stable, so that a test can select one. The input of each fixed bug
/// is added here.
std::vector<std::pair<std::string, Skeleton>> skeleton_zoo();

/// Returns the skeleton of that name; throws std::out_of_range if there is none.
Skeleton zoo_skeleton(const std::string& name);

}  // namespace coppice
