#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A number for every node beside its place and radius: how well an extraction is sure of it, say.
struct NodeAttribute {
    std::string name;           ///< see is_attribute_name()
    std::vector<float> values;  ///< one per node, finite
};

/// Whether an attribute may have this name: small letters, digits and _, a letter first, and nothing that
/// skeletons in files have themselves, such as radius or parent.
bool is_attribute_name(std::string_view name);

/// The attributes of `before` for what edits made of it: nodes that were there keep theirs, found by their
/// stable ids, new ones have those of their parents, new roots 0. O(n log n).
std::vector<NodeAttribute> carried_attributes(std::span<const NodeAttribute> attributes,
                                              const Skeleton& before, const Skeleton& after);

}  // namespace coppice
