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
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/points/painted_points.h"

namespace coppice {

// What `coppice extract` and the command of scenes have in common.

/// What tells trees of a cloud apart.
enum class TreeRule {
    stems,  ///< what hangs on each stem
    ids     ///< the ids that the points have
};

template <>
struct EnumNames<TreeRule> {
    static constexpr std::array<std::string_view, 2> names{"stems", "ids"};
};

/// Of both kinds of input, and so not among the options of either.
inline constexpr Field kFileUpField =
    common_field("up", "Axis of the file that points up; y for OBJ files from Blender and games");
/// See parse_wood_classes().
inline constexpr Field kWoodClassesField{
    "wood_classes",
    "LAS classes of points that may be wood, as 4,5,20-22; auto leaves out ground, noise, buildings and what "
    "else cannot be trees; all keeps every class"};

/// See TreeRule.
inline constexpr Field kTreesByField{
    "trees_by", "What tells trees apart: their stems, or the ids of trees that points have"};

/// The trees that the points of a file name, each extracted by itself. Throws InvalidInput where points
/// have no ids or none of them has 50 points; and as extract_trees() does.
PlotExtraction extract_trees_by_ids(const PaintedPoints& scan, const CloudOptions& options,
                                    const Context& ctx);

/// What is known of every node of an extracted skeleton, to be kept with it; uncertainties only of clouds,
/// whose radii are estimates.
std::vector<NodeAttribute> node_attributes(std::span<const NodeConfidence> confidence, bool cloud);

/// What `node_attributes` of a cloud made of it, so that figures of a skeleton that was written are those of
/// the extraction; empty where the attributes are others, or of a mesh.
std::vector<NodeConfidence> node_confidence(std::span<const NodeAttribute> attributes);

/// ", 312 of 5,000 points left out as leaves": what is said of points that were thinned, and of leaves, which
/// a user misses first.
std::string text_of_points_left_out(const CloudReport& cleaning);

/// Height, diameter at breast height, length and volume of a tree, with what is known of their errors.
std::string text_of_tree(const TreeFigures& tree);

}  // namespace coppice
