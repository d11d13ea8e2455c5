#pragma once

#include <string>

#include "coppice/base/column.h"

namespace coppice {

/// A number for every vertex of a mesh.
struct VertexAttribute {
    std::string name;      ///< lower case: letters, digits and underscores
    Buffer<float> values;  ///< one per vertex
};

}  // namespace coppice
