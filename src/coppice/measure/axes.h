#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/cone_union.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A place where a branch is severed: where its axis leaves the surface, or is too near to it.
struct SeveredPlace {
    NodeId node;        ///< child node of the segment on which the place begins
    Vec3d place;        ///< [m] begin of the place, with the skeleton's origin
    double length = 0;  ///< [m] along the axis
    friend bool operator==(const SeveredPlace&, const SeveredPlace&) = default;  ///< member by member
};

/// A tip of a skeleton that the surface does not reach.
struct ShortTip {
    NodeId node;         ///< the tip
    Vec3d place;         ///< [m] position of the tip, with the skeleton's origin
    double missing = 0;  ///< [radii of the tip] length by which the surface ends too early
    friend bool operator==(const ShortTip&, const ShortTip&) = default;  ///< member by member
};

/// Measures whether the axes of a skeleton are inside a surface along their whole length and deep enough, and
/// whether the surface reaches their tips. Points within 1.2 radii of a root or a tip are excluded.
struct AxesReport {
    static constexpr double kThin = 0.4;   ///< [radii] minimum depth; axes nearer to the surface are severed
    static constexpr double kShort = 0.1;  ///< [radii] minimum length that is missing at a short tip
    /// Maximum share of the axes that is cut off, and of the tips that are short.
    static constexpr double kMaxLost = 0.01;
    static constexpr std::size_t kNamed = 5;  ///< maximum number of places and tips that are listed

    double length = 0;           ///< [m] of the examined axes
    double outside = 0;          ///< [m] of that length outside the surface
    double thin = 0;             ///< [m] of that length inside, but nearer to the surface than kThin
    std::uint64_t segments = 0;  ///< number of examined segments
    /// Of these, segments that are outside the surface with over half of their length.
    std::uint64_t missing = 0;
    std::uint64_t severed = 0;          ///< number of places longer than a fifth of the radius
    std::vector<SeveredPlace> longest;  ///< the longest of these, by decreasing length
    double beyond = 0;                  ///< [m] of axes at and beyond the places where they leave the surface

    std::uint64_t tips = 0;        ///< number of tips of all branches
    std::uint64_t short_tips = 0;  ///< number of short tips, see kShort
    Statistics tip_reach;          ///< [radii] of tips that are in no other branch
    /// The short tips with the largest missing length, by decreasing length.
    std::vector<ShortTip> shortest;

    /// Of the length of the axes.
    double outside_percent() const { return length > 0 ? 100 * outside / length : 0; }
    /// Of the length of the axes.
    double thin_percent() const { return length > 0 ? 100 * thin / length : 0; }
    /// Of the length of the axes.
    double beyond_percent() const { return length > 0 ? 100 * std::min(1.0, beyond / length) : 0; }
    /// No severed place and no short tip.
    bool is_perfect() const { return severed == 0 && short_tips == 0; }
    /// Returns whether the share of the axes that is cut off is within kMaxLost.
    bool is_whole() const { return beyond <= kMaxLost * length; }
    /// Returns whether the share of the tips that are short is within kMaxLost.
    bool reaches_tips() const {
        return static_cast<double>(short_tips) <= kMaxLost * static_cast<double>(tips);
    }
    friend bool operator==(const AxesReport&, const AxesReport&) = default;  ///< member by member
};

/// A portion of the axis of a segment at which a branch is severed.
struct SeveredRange {
    NodeId node;      ///< child node of the segment
    double from = 0;  ///< parameter of the segment, from its parent, at which the portion begins
    double to = 1;    ///< parameter at which it ends
};

/// The result of judge_axes().
struct AxesFound {
    AxesReport report;  ///< the figures
    /// Per capsule of the union: whether every point of its axis is inside the surface at a depth of at least
    /// half the local radius. Then no point of the capsule is farther outside than that.
    std::vector<std::uint8_t> is_deep;
    /// Child nodes of the segments on which severed places begin, and short tips; unordered.
    std::vector<NodeId> faulty;
};

/// Compares the axes of a skeleton with a valid, closed surface, its faces counter-clockwise seen from
/// outside. `solid` must be the union of the skeleton, in the frame of the mesh; `tips` is the shape of its
/// branch ends. Where the surface is nearer to an axis than half its radius, the axis is sampled every half
/// radius, at 256 points of a segment at most. O(n) for the faces, O(log n) for each segment and point; about
/// 10 microseconds a segment at two subdivision levels.
AxesFound judge_axes(const FaceView& mesh, const Skeleton& skeleton, const ConeUnion& solid, EndShape tips,
                     const Context& ctx = {});

/// Returns the portions of the axes of some segments (`wanted`, by node) at which a surface severs them,
/// grouped by place, and the last radius of those that end in a short tip, `tips` being the shape of branch
/// ends. The mesh needs only the faces within two radii of these segments. `segments` must be the capsules of
/// the skeleton, in the frame of the mesh.
std::vector<SeveredRange> find_severed_ranges(const FaceView& mesh, const Skeleton& skeleton,
                                              const CapsuleTree& segments, EndShape tips,
                                              std::span<const std::uint8_t> wanted, const Context& ctx = {});

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const SeveredPlace& p, Visitor&& visit) {
    visit("node", p.node.index());
    visit("x", p.place.x);
    visit("y", p.place.y);
    visit("z", p.place.z);
    visit("length", p.length);
}

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const ShortTip& t, Visitor&& visit) {
    visit("node", t.node.index());
    visit("x", t.place.x);
    visit("y", t.place.y);
    visit("z", t.place.z);
    visit("missing", t.missing);
}

/// Calls visit(name, value) for the figures of the axes, in order; the figures of tips are excluded.
template <class Visitor>
void visit_figures(const AxesReport& r, Visitor&& visit) {
    visit("length", r.length);
    visit("outside_percent", r.outside_percent());
    visit("thin_percent", r.thin_percent());
    visit("severed", r.severed);
    visit("beyond_percent", r.beyond_percent());
}

}  // namespace coppice
