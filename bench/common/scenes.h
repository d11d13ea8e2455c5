#pragma once

#include <string>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

struct Scene {
    std::string name;
    Skeleton skeleton;
};

/// Returns the default scenes, from small to large.
std::vector<std::string> default_scenes();

/// Returns a synthetic tree by its name (tree300, tree3k, tree30k, tree300k; with suffix `hard` the same size
/// with whorls, acute forks and short segments), or otherwise the skeleton in the file of that name. Throws
/// InvalidInput or IoError.
Scene make_scene(const std::string& name_or_file);

}  // namespace coppice::bench
