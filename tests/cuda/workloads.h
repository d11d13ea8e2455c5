#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "coppice/skeleton/skeleton.h"
#include "paths.h"

namespace coppice {

/// Returns a skeleton of the workloads next to the checkout, by the name of its file of "id type x y z radius
/// parent"; no value if it is missing.
inline std::optional<Skeleton> workload(const std::string& name) {
    std::ifstream file(source_dir() / ".." / "shared" / "workloads" / name);
    if (!file) return {};
    std::vector<NodeId> parent, id_of{NodeId::none()};
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        std::int64_t id = 0, type = 0, up = 0;
        Vec3 p;
        float r = 0;
        if (!(in >> id >> type >> p.x >> p.y >> p.z >> r >> up)) continue;
        id_of.resize(std::max<std::size_t>(id_of.size(), static_cast<std::size_t>(id) + 1));
        id_of[static_cast<std::size_t>(id)] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(up > 0 ? id_of[static_cast<std::size_t>(up)] : NodeId::none());
        position.push_back(p);
        radius.push_back(r);
    }
    return Skeleton(std::move(parent), std::move(position), std::move(radius));
}

}  // namespace coppice
