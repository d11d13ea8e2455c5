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

/// A place where a branch is severed: where its axis leaves the surface, or comes too near to it.
struct SeveredPlace {
    NodeId node;        ///< that names the segment on which it begins
    Vec3d place;        ///< [m] where it begins, with the skeleton's origin
    double length = 0;  ///< [m] of axis
    friend bool operator==(const SeveredPlace&, const SeveredPlace&) = default;  ///< member by member
};

/// A tip of a skeleton that the surface does not reach.
struct ShortTip {
    NodeId node;         ///< the tip
    Vec3d place;         ///< [m] of it, with the skeleton's origin
    double missing = 0;  ///< [radii of the tip] that the surface ends too early
    friend bool operator==(const ShortTip&, const ShortTip&) = default;  ///< member by member
};

/// Whether the axes of a skeleton lie within a surface, all along and deep enough, and whether it reaches as
/// far as their tips. What lies within 1.2 radii of a root or a tip is not judged.
struct AxesReport {
    static constexpr double kThin = 0.4;   ///< [radii] axes that come nearer to the surface are severed
    static constexpr double kShort = 0.1;  ///< [radii] tips that end by more before what is meant are short
    static constexpr double kMostLost = 0.01;  ///< of the axes to be cut off, and of tips to be short
    static constexpr std::size_t kNamed = 5;   ///< places and tips at most that are named

    double length = 0;                  ///< [m] of axes that were judged
    double outside = 0;                 ///< [m] of that outside of the surface
    double thin = 0;                    ///< [m] of that inside, but nearer to the surface than kThin
    std::uint64_t segments = 0;         ///< that were judged
    std::uint64_t missing = 0;          ///< of these, those that lie outside with over half of their length
    std::uint64_t severed = 0;          ///< places longer than a fifth of the radius
    std::vector<SeveredPlace> longest;  ///< of these, by length
    double beyond = 0;  ///< [m] of axes beyond the places where they leave the surface, and there

    std::uint64_t tips = 0;          ///< of all branches
    std::uint64_t short_tips = 0;    ///< see kShort
    Statistics tip_reach;            ///< [radii] of tips that lie in no other branch
    std::vector<ShortTip> shortest;  ///< short tips, those of which most is missing first

    double outside_percent() const { return length > 0 ? 100 * outside / length : 0; }  ///< of the axes
    double thin_percent() const { return length > 0 ? 100 * thin / length : 0; }        ///< of the axes
    double beyond_percent() const {
        return length > 0 ? 100 * std::min(1.0, beyond / length) : 0;
    }                                                                    ///< of the axes
    bool is_perfect() const { return severed == 0 && short_tips == 0; }  ///< nothing at all is wrong
    /// Hardly anything is cut off: by kMostLost.
    bool is_whole() const { return beyond <= kMostLost * length; }
    /// Hardly any tip is short: by kMostLost.
    bool reaches_tips() const {
        return static_cast<double>(short_tips) <= kMostLost * static_cast<double>(tips);
    }
    friend bool operator==(const AxesReport&, const AxesReport&) = default;  ///< member by member
};

/// A part of the axis of a segment at which a branch is severed.
struct SeveredPart {
    NodeId node;      ///< that names the segment
    double from = 0;  ///< parameter of the segment, from its parent, at which it begins
    double to = 1;    ///< the same, at which it ends
};

/// What was found about the axes of a skeleton.
struct AxesFound {
    AxesReport report;  ///< what is told of them
    /// Per capsule of the union: whether every point of its axis lies inside of the surface, by half the
    /// radius there or more. Then no point of it lies outside by more than that.
    std::vector<std::uint8_t> is_deep;
    /// Those that name the segments on which severed places begin, and short tips; in no order.
    std::vector<NodeId> faulty;
};

/// Judges a valid, closed surface of faces that run counter-clockwise seen from outside by the axes of a
/// skeleton. `solid` has to be that of the skeleton, in the frame of the mesh, and `tips` how its branches
/// end. Where the surface comes nearer to an axis than half its radius, that is looked at every half radius,
/// at 256 points of a segment at most. O(n) for the faces, O(log n) for each segment and point; some 10
/// microseconds a segment at two levels.
AxesFound judge_axes(const FaceView& mesh, const Skeleton& skeleton, const ConeUnion& solid, EndShape tips,
                     const Context& ctx = {});

/// The parts of the axes of some segments, `wanted` by node, at which a surface severs them, place by place.
/// The mesh needs to have only the faces within two radii of these segments. `segments` are those of the
/// skeleton, in the frame of the mesh.
std::vector<SeveredPart> severed_parts(const FaceView& mesh, const Skeleton& skeleton,
                                       const CapsuleTree& segments, std::span<const std::uint8_t> wanted,
                                       const Context& ctx = {});

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

/// Calls visit(name, value) for what is told of the axes, in order; tips are left to others.
template <class Visitor>
void visit_figures(const AxesReport& r, Visitor&& visit) {
    visit("length", r.length);
    visit("outside_percent", r.outside_percent());
    visit("thin_percent", r.thin_percent());
    visit("severed", r.severed);
    visit("beyond_percent", r.beyond_percent());
}

}  // namespace coppice
