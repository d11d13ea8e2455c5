#pragma once

#include <span>
#include <string>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/extract_result.h"
#include "coppice/io/skeleton/node_attribute.h"

namespace coppice {

// What `coppice extract` and the command of scenes have in common.

/// Of both kinds of input, and so not among the options of either.
inline constexpr Field kFileUpField =
    common_field("up", "Axis of the file that points up; y for OBJ files from Blender and games");
/// See parse_wood_classes().
inline constexpr Field kWoodClassesField{
    "wood_classes",
    "LAS classes of points that may be wood, as 4,5,20-22; auto leaves out ground, noise, buildings and what "
    "else cannot be trees; all keeps every class"};

/// What is known of every node of an extracted skeleton, to be kept with it; uncertainties only of clouds,
/// whose radii are estimates.
std::vector<NodeAttribute> node_attributes(std::span<const NodeConfidence> confidence, bool cloud);

/// ", 312 of 5,000 points left out as leaves": what is said of points that were thinned, and of leaves, which
/// a user misses first.
std::string text_of_points_left_out(const CloudReport& cleaning);

/// The diameter at breast height and the volume of a tree, with what is known of their errors.
std::string text_of_tree(const TreeFigures& tree);

}  // namespace coppice
