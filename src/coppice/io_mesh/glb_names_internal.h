#pragma once

#include <string>

namespace coppice::io_internal {

/// Returns the name of an attribute of vertices in glTF: `_ORDER` of `order`.
inline std::string glb_attribute_name(std::string name) {
    for (char& c : name) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return "_" + name;
}

}  // namespace coppice::io_internal
