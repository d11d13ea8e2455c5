#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How the last half ball of a branch, or of a tree below its root, ends: whole, or cut off at its disc.
enum class EndShape { round, flat };

template <>
struct EnumNames<EndShape> {
    static constexpr std::array<std::string_view, 2> names{"round", "flat"};
};

/// The solid that the radii of a skeleton mean: the union of the rounded cones of its segments, of the balls
/// of trees of one node, and of those of roots that are much thicker than what leaves them, as somas are. A
/// point belongs to a segment when it is no farther from its axis than the segment's radius at the foot (see
/// BasicRoundCone and Skeleton for where a lateral's radius begins).
///
/// A flat base is that of a root with one child: what lies beyond the plane through the root across its
/// segment is cut off within three radii of the root, of the segments that begin within as much along the
/// branches. Flat tips likewise.
class ConeUnion {
  public:
    /// `origin` is that of the points that will be asked about; the skeleton may go afterwards. O(n log n).
    ConeUnion(const Skeleton& skeleton, Vec3d origin, EndShape base, EndShape tips, const Context& ctx = {});

    /// Segments, and balls of roots; by their (child) node in `capsules().node(i)`.
    const CapsuleTree& capsules() const { return capsules_; }

    /// Whether solid i has p, given the foot of p on its axis; cuts are counted.
    bool has(std::uint32_t i, Vec3d p, const RoundCone::Foot& foot) const {
        return foot.relative_squared() <= 1 && !is_cut_off(i, p);
    }

    bool contains(Vec3d p) const;                     ///< O(log n)
    bool is_cut_off(std::uint32_t i, Vec3d p) const;  ///< whether a flat end takes p from solid i
    bool has_cuts() const { return !cuts_.empty(); }  ///< whether any end is flat

    /// A flat end.
    struct Cut {
        Vec3d center;   ///< of the disc
        Vec3d outward;  ///< unit normal
        double radius;  ///< [m] of the disc
    };
    const std::vector<Cut>& cuts() const { return cuts_; }  ///< bases first, each by node
    /// The flat ends that may take something from solid i: places in cuts().
    std::span<const std::uint32_t> cuts_of(std::uint32_t i) const { return cuts_of_[i]; }

  private:
    CapsuleTree capsules_;
    std::vector<Cut> cuts_;
    CompressedRows<std::uint32_t> cuts_of_;  ///< by capsule
};

}  // namespace coppice
