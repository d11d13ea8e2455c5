#pragma once

#include <array>
#include <span>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/instances.h"

namespace coppice {

/// How a file stores placed copies.
enum class InstanceStorage {
    instanced,  ///< each prototype once, with the places of its copies; GLB and USDA only
    merged,     ///< all copies as plain meshes, for programs that do not read instances
};

template <>
struct EnumNames<InstanceStorage> {
    static constexpr std::array<std::string_view, 2> names{"instanced", "merged"};
};

/// Placed copies that a file contains in addition to the surface, such as leaves.
struct InstancedParts {
    std::span<const Prototype> prototypes;     ///< with different names
    std::span<const MaterialFiles> materials;  ///< of the prototypes, with names different from all others
    const Instances* instances = nullptr;      ///< may be null: no copies
    InstanceStorage storage = InstanceStorage::instanced;  ///< OBJ, PLY and STL always merge

    /// Returns whether there are no copies.
    bool empty() const { return instances == nullptr || instances->empty(); }
};

}  // namespace coppice
