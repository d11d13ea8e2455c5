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

/// Shape of the end of a branch, or of a tree below its root: a half ball, or cut off at its disc.
enum class EndShape { round, flat };

template <>
struct EnumNames<EndShape> {
    static constexpr std::array<std::string_view, 2> names{"round", "flat"};
};

/// The solid defined by the radii of a skeleton: the union of the rounded cones of its segments, of the balls
/// of trees with one node, and of the balls of roots that are much thicker than their branches, as somas are.
/// A point belongs to a segment if its distance to the axis is at most the segment's radius at the closest
/// point (see BasicRoundCone and Skeleton for where the radius of a lateral begins).
///
/// Only roots with one child have a flat base: it removes the points beyond the plane through the root,
/// perpendicular to its segment, that are within three radii of the root, from the segments that begin within
/// that distance along the branches. Flat tips likewise.
class ConeUnion {
  public:
    /// `origin` must be the origin of the query points. The skeleton is not referenced afterwards. O(n log
    /// n).
    ConeUnion(const Skeleton& skeleton, Vec3d origin, EndShape base, EndShape tips, const Context& ctx = {});

    /// Segments, and balls of roots; `capsules().node(i)` is the (child) node of solid i.
    const CapsuleTree& capsules() const { return capsules_; }

    /// Returns whether solid i contains p, given the closest point on its axis; cuts are considered.
    bool has(std::uint32_t i, Vec3d p, const RoundCone::ClosestPoint& closest) const {
        return closest.relative_squared() <= 1 && !is_cut_off(i, p);
    }

    bool contains(Vec3d p) const;                     ///< O(log n)
    bool is_cut_off(std::uint32_t i, Vec3d p) const;  ///< whether a flat end removes p from solid i
    bool has_cuts() const { return !cuts_.empty(); }  ///< whether any end is flat

    /// A flat end.
    struct Cut {
        Vec3d center;   ///< of the disc
        Vec3d outward;  ///< unit normal
        double radius;  ///< [m] of the disc
    };
    const std::vector<Cut>& cuts() const { return cuts_; }  ///< bases first, each group by node
    /// Returns the flat ends that may shorten solid i, as indices of cuts().
    std::span<const std::uint32_t> compute_cuts(std::uint32_t i) const { return cuts_of_[i]; }

  private:
    CapsuleTree capsules_;
    std::vector<Cut> cuts_;
    CompressedRows<std::uint32_t> cuts_of_;  ///< by capsule
};

}  // namespace coppice
