#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Method of resampling the nodes between branch nodes.
enum class ResampleMethod {
    none,      ///< keep the nodes unchanged
    zhu,       ///< the rule of [Zhu2015] section 3.1
    simplify,  ///< Douglas-Peucker on position and radius, then spacing, then rings where needed
};

template <>
struct EnumNames<ResampleMethod> {
    static constexpr std::array<std::string_view, 3> names{"none", "zhu", "simplify"};
};

/// Options for resampling the nodes between branch nodes. Roots, branch nodes and tips are always kept.
struct ResampleOptions {
    ResampleMethod method = ResampleMethod::simplify;  ///< method
    float tolerance = 0.02f;   ///< [radius] simplify: maximum shift of the surface; in [0, 1]
    float min_spacing = 0.9f;  ///< [radius] simplify: minimum distance between nodes of a chain; in [0, 10]
    float max_length = 20;     ///< [radius] simplify: maximum length of a segment; in [1, 1e6]
    /// [rad] simplify: angle above which a turn gets a ring on each side; in [0, pi]
    float bend_angle = 0.6f;
    float bend_spacing = 1.5f;  ///< [radius] simplify: distance of these rings from the turn; in [0.1, 10]
    float zhu_angle = 0.1f;     ///< [rad] zhu: angle below which a node is removed; in [0, pi]
    /// [radius] zhu: distance to a neighbour below which a node is removed; in [0, 10]
    float zhu_spacing = 1.1f;
};

/// Lists the members for front ends.
void list_fields(ResampleOptions& o, FieldList& list);

/// Numbers of changes by `resample`.
struct ResampleReport {
    std::uint32_t removed = 0;  ///< removed nodes
    std::uint32_t moved = 0;    ///< nodes moved apart to keep both radii of a jump in radius
    /// nodes inserted on long segments, next to turns, before tips, and at roots
    std::uint32_t inserted = 0;
};

/// A resampled skeleton, with a report of the changes.
struct ResampleResult {
    Skeleton skeleton;      ///< resampled skeleton
    ResampleReport report;  ///< changes
    /// By old node: the node itself or, if it was removed, the next kept one towards the tip.
    std::vector<NodeId> new_of_old;
};

/// Resamples every chain, that is the nodes between two of roots, branch nodes and tips.
///
/// `simplify` keeps the nodes that determine the surface: the distance of every old node, as a ball, from the
/// new axis, in position and radius together, is at most `tolerance`. Then, of two nodes closer than
/// `min_spacing` (times the smaller radius), the one with less influence is removed, unless the radius
/// changes by more than a fifth between them: then they are moved apart. Nodes of laterals within the ball of
/// their branch node, which are invisible, are removed. If a removal would move the surface by over a tenth
/// of the radius, the node is moved along its segment instead, if there is room. Then segments longer than
/// `max_length` (in local radii) are split evenly, and rings are inserted next to sharp turns, before tips of
/// long segments, and where branches leave a root with several children (outside of its ball, see is_ball);
/// no rings are inserted if `bend_angle` is pi or more. The number of insertions is bounded: if a skeleton
/// would grow more than threefold, `max_length` is increased.
///
/// The leaders at branch nodes are unchanged, so laterals keep their own radius at the start. Throws
/// InvalidInput if an option is out of range. O(n log n), not recursive.
ResampleResult resample(const Skeleton& skeleton, const ResampleOptions& options = {});

}  // namespace coppice
