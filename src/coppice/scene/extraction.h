#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/extract_result.h"
#include "coppice/extract/plot/plot.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/points/point_cloud.h"

namespace coppice {

// Shared code of `coppice extract` and the scene command.

/// Criterion that separates the trees of a cloud.
enum class TreeRule {
    stems,  ///< connection with each stem
    ids     ///< tree ids of the points
};

template <>
struct EnumNames<TreeRule> {
    static constexpr std::array<std::string_view, 2> names{"stems", "ids"};
};

/// Applies to both kinds of input, and is therefore not part of the options of either.
inline constexpr Field kFileUpField =
    common_field("up", "Axis of the file that points up; y for OBJ files from Blender and games.");
/// See parse_wood_classes().
inline constexpr Field kWoodClassesField{
    "wood_classes",
    "LAS classes of points that may be wood, as 4,5,20-22; auto leaves out ground, noise, buildings and "
    "other classes that cannot be trees; all keeps every class."};

/// See TreeRule.
inline constexpr Field kTreesByField{
    "trees_by", "Criterion that separates trees: their stems, or the tree ids of points."};

/// Extracts each tree with ids in the points of a file separately. Throws InvalidInput if points have no ids
/// or no id has 50 points; and as extract_trees() does.
PlotExtraction extract_trees_by_ids(const PointCloud& scan, const CloudOptions& options, const Context& ctx);

/// Returns the attributes of the nodes of an extracted skeleton; uncertainties only for clouds, because their
/// radii are estimates.
std::vector<NodeAttribute> node_attributes(std::span<const NodeConfidence> confidence, bool cloud);

/// Inverts `node_attributes` of a cloud, so that the figures of a saved skeleton are those of the extraction;
/// empty for other attributes, or those of a mesh.
std::vector<NodeConfidence> node_confidence(std::span<const NodeAttribute> attributes);

/// Returns a text such as ", 312 of 5,000 points left out as leaves": the number of thinned points, and of
/// points left out as leaves, which users notice first.
std::string text_of_points_left_out(const CloudReport& cleaning);

/// Returns height, diameter at breast height, length and volume of a tree, with their known errors.
std::string text_of_tree(const TreeFigures& tree);

}  // namespace coppice
