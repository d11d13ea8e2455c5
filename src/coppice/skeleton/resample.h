#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// By what rule nodes between branch nodes go and come.
enum class ResampleMethod {
    none,      ///< leave the nodes as they are
    zhu,       ///< the rule of [Zhu2015] section 3.1
    simplify,  ///< Douglas-Peucker on position and radius, then spacing, then rings where they are needed
};

template <>
struct EnumNames<ResampleMethod> {
    static constexpr std::array<std::string_view, 3> names{"none", "zhu", "simplify"};
};

/// How the nodes between branch nodes are chosen. Roots, branch nodes and tips always stay.
struct ResampleOptions {
    ResampleMethod method = ResampleMethod::simplify;  ///< the rule
    float tolerance = 0.02f;    ///< [radius] simplify: how far the surface may move; in [0, 1]
    float min_spacing = 0.9f;   ///< [radius] simplify: least distance of nodes along a chain; in [0, 10]
    float max_length = 20;      ///< [radius] simplify: longer segments are split; in [1, 1e6]
    float bend_angle = 0.6f;    ///< [rad] simplify: a sharper turn gets a ring on either side; in [0, pi]
    float bend_spacing = 1.5f;  ///< [radius] simplify: how far from the turn; in [0.1, 10]
    float zhu_angle = 0.1f;     ///< [rad] zhu: a node that turns by less goes; in [0, pi]
    float zhu_spacing = 1.1f;   ///< [radius] zhu: a node nearer to a neighbour goes; in [0, 10]
};

template <class Self, class Visitor>
requires SameOptions<Self, ResampleOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"resample", "How the nodes between branch nodes are chosen"}, o.method);
    visit(Field{"tolerance", "Greatest shift of the surface by leaving out nodes", Unit::radius, 0, 1},
          o.tolerance);
    visit(Field{"min_spacing", "Least distance of nodes along a chain", Unit::radius, 0, 10}, o.min_spacing);
    visit(Field{"max_length", "Length above which a segment is split", Unit::radius, 1, 1e6}, o.max_length);
    visit(Field{"bend_angle", "Turn above which a node gets a ring on either side", Unit::radian, 0, 3.15},
          o.bend_angle);
    visit(Field{"bend_spacing", "Distance of the rings beside a sharp turn", Unit::radius, 0.1, 10},
          o.bend_spacing);
    visit(Field{"zhu_angle", "Turn below which the method zhu drops a node", Unit::radian, 0, 3.15},
          o.zhu_angle);
    visit(Field{"zhu_spacing", "Distance below which the method zhu drops a node", Unit::radius, 0, 10},
          o.zhu_spacing);
}

/// What `resample` changed, counted.
struct ResampleReport {
    std::uint32_t removed = 0;   ///< nodes left out
    std::uint32_t moved = 0;     ///< nodes pushed apart, so that a jump in radius keeps both of its radii
    std::uint32_t inserted = 0;  ///< nodes added on long segments, beside turns, before tips, and at roots
};

/// A resampled skeleton, and what was done to it.
struct ResampleResult {
    Skeleton skeleton;      ///< the new one
    ResampleReport report;  ///< what was done
    /// For every old node: itself, or where it was left out, the next one kept towards the tip.
    std::vector<NodeId> new_of_old;
};

/// Chooses the nodes anew along every chain, that is between two of roots, branch nodes and tips.
///
/// `simplify` keeps what the surface needs: no old node, seen as a ball, ends up farther than `tolerance`
/// from the new axis, in position and radius together. Then of two nodes nearer than `min_spacing` (times the
/// lesser radius) the one of less influence goes, unless the radius jumps by more than a fifth between them:
/// then they are pushed apart. Laterals lose the nodes within their branch node's ball, which nothing shows
/// of. Where either would move the surface by over a tenth of the radius, the node moves on along its segment
/// in place of going, if there is room. Then segments longer than `max_length` (in local radii) are split
/// evenly, and rings come beside sharp turns, before tips of long segments, and where branches leave a root
/// that several leave (outside of its ball, where it is one: see is_ball); none of these where `bend_angle`
/// is pi or more. Insertion is bounded: on skeletons that would grow more than threefold `max_length` is
/// raised.
///
/// Which child leads at a branch node stays the same, so laterals keep their own radius at the start.
/// Throws InvalidInput when an option is out of its range. O(n log n), no recursion.
ResampleResult resample(const Skeleton& skeleton, const ResampleOptions& options = {});

}  // namespace coppice
