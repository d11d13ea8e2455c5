#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// A number for every node beside its place and radius: how well an extraction is sure of it, say.
struct NodeAttribute {
    std::string name;           ///< see is_attribute_name()
    std::vector<float> values;  ///< one per node, finite
};

/// Whether an attribute may have this name: small letters, digits and _, a letter first, and nothing that
/// skeletons in files have themselves, such as radius or parent.
bool is_attribute_name(std::string_view name);

}  // namespace coppice
