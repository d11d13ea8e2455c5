#include "coppice/io_skeleton/node_attribute.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace coppice {

bool is_attribute_name(std::string_view name) {
    static constexpr std::array<std::string_view, 12> kTaken{"x",      "y",       "z",        "r",
                                                             "radius", "parent",  "position", "stable_id",
                                                             "origin", "version", "format",   "units"};
    const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
    const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
    return !name.empty() && is_letter(name.front()) && std::ranges::all_of(name, fits) &&
           std::ranges::find(kTaken, name) == kTaken.end();
}

std::vector<NodeAttribute> kept_attributes(std::span<const NodeAttribute> attributes, const Skeleton& before,
                                           const Skeleton& after) {
    if (attributes.empty()) return {};
    std::unordered_map<std::uint32_t, NodeId> node_of_id;
    for (const NodeId n : nodes(before)) node_of_id.emplace(before.stable_id(n).index(), n);
    std::vector<NodeAttribute> out;
    for (const NodeAttribute& a : attributes) out.push_back({a.name, std::vector<float>(after.size(), 0)});
    for (const NodeId n : nodes(after)) {
        const auto found = node_of_id.find(after.stable_id(n).index());
        for (std::size_t k = 0; k < out.size(); ++k) {
            float& value = out[k].values[n.index()];
            if (found != node_of_id.end()) {
                value = attributes[k].values[found->second.index()];
            } else if (!after.is_root(n)) {
                value = out[k].values[after.parent(n).index()];
            }
        }
    }
    return out;
}

}  // namespace coppice
