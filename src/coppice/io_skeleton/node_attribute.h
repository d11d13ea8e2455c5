#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A number for every node in addition to its position and radius, such as the confidence of an extraction.
struct NodeAttribute {
    std::string name;           ///< see is_attribute_name()
    std::vector<float> values;  ///< one for each node, finite
};

/// Returns whether an attribute may have this name: lower case letters, digits and _, beginning with a
/// letter, and not a standard property of skeleton files, such as radius or parent.
bool is_attribute_name(std::string_view name);

/// Returns the attributes of `after`, an edited version of `before`: existing nodes, identified by their
/// stable ids, keep theirs, new nodes copy those of their parents, new roots get 0. O(n log n).
std::vector<NodeAttribute> kept_attributes(std::span<const NodeAttribute> attributes, const Skeleton& before,
                                           const Skeleton& after);

}  // namespace coppice
