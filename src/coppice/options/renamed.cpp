#include "coppice/options/renamed.h"

#include <algorithm>
#include <array>
#include <utility>

namespace coppice {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 21> kRenamed{{
    {"detail", "leaf_cluster_distance"},
    {"edge", "tetra_edge"},
    {"field_width", "kernel_width"},
    {"greatest_diameter", "max_diameter"},
    {"least_angle", "min_angle"},
    {"least_diameter", "min_diameter"},
    {"least_length", "min_tree_length"},
    {"least_orders", "min_orders"},
    {"least_tips", "min_tips"},
    {"most_intersections", "max_intersections"},
    {"most_length", "max_tree_length"},
    {"most_orders", "max_orders"},
    {"most_places", "max_places"},
    {"most_points", "max_points"},
    {"most_tips", "max_tips"},
    {"passes", "untangle_passes"},
    {"quality", "untangle_quality"},
    {"step", "twig_node_spacing"},
    {"take_least_length", "take_min_length"},
    {"twig", "min_twig_height"},
    {"width", "kernel_width"},
}};

}  // namespace

std::string_view present_name(std::string_view former) {
    const auto* const found =
        std::ranges::find(kRenamed, former, [](const auto& pair) { return pair.first; });
    return found == kRenamed.end() ? std::string_view() : found->second;
}

}  // namespace coppice
