#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A node as read from a file, before validation.
struct RawNode {
    std::int64_t id = 0;       ///< any unique number
    std::int64_t parent = -1;  ///< an id; a negative number, or an id that no node has, means a root
    Vec3d position;            ///< [m] in world space
    double radius = 0;         ///< [m]; NaN or less than 1e-12 means missing
    std::uint32_t line = 0;    ///< line (or record) of the file, from 1; 0: unknown
    StableId stable_id = {};   ///< see Skeleton::stable_id; set for all nodes or for no node
};

/// A cylinder of a quantitative structure model, before validation.
struct RawCylinder {
    std::int64_t id = 0;       ///< any unique number
    std::int64_t parent = -1;  ///< as in RawNode
    Vec3d start;               ///< [m] in world space
    Vec3d end;                 ///< [m] in world space
    double radius = 0;         ///< [m]; NaN or less than 1e-12 means missing
    std::uint32_t line = 0;    ///< as in RawNode
};

/// Numbers of repairs by `repair`.
struct RepairReport {
    std::uint32_t reordered = 0;        ///< nodes that preceded their parents
    std::uint32_t missing_parents = 0;  ///< nodes with a parent that does not exist: they became roots
    std::uint32_t missing_radii = 0;    ///< zero, negative or unknown radii: interpolated along the chain
    std::uint32_t zero_length = 0;      ///< segments without length: merged into their parents
    std::uint32_t coincident = 0;  ///< nodes at the position of another child of their parent: merged into it
    /// cylinders with a distance of more than their radius between start and attachment
    std::uint32_t bridged_gaps = 0;
    std::uint32_t attached_inside = 0;  ///< cylinders attached between the ends of their parent
    /// cylinders with a radius that differs by more than 1 % from the previous one
    std::uint32_t radius_jumps = 0;
    /// Returns the number of errors of the file; gaps and jumps are inherent to cylinders.
    std::uint32_t total() const {
        return reordered + missing_parents + missing_radii + zero_length + coincident;
    }
};

/// Calls visit(name, value) for every error of the file, in order.
template <class Visitor>
void visit_errors(const RepairReport& r, Visitor&& visit) {
    visit("reordered", r.reordered);
    visit("missing_parents", r.missing_parents);
    visit("missing_radii", r.missing_radii);
    visit("zero_length", r.zero_length);
    visit("coincident", r.coincident);
}

/// Calls visit(name, value) for every kind of joint between cylinders, in order.
template <class Visitor>
void visit_joints(const RepairReport& r, Visitor&& visit) {
    visit("bridged_gaps", r.bridged_gaps);
    visit("attached_inside", r.attached_inside);
    visit("radius_jumps", r.radius_jumps);
}

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const RepairReport& r, Visitor&& visit) {
    visit_errors(r, visit);
    visit_joints(r, visit);
}

/// A valid skeleton, with a report of the repairs.
struct RepairResult {
    Skeleton skeleton;    ///< every node of the input except the merged ones
    RepairReport report;  ///< repairs
    /// by node: index of the raw node, or of the raw cylinder that contains its segment
    std::vector<std::uint32_t> source;
};

/// Converts raw nodes to a valid skeleton. Parents are moved before their children, otherwise the order is
/// kept. Nodes without a parent become roots. A missing radius is interpolated linearly by length between the
/// closest known ones towards the root and the tip; if there is only one, it is used; without any, the
/// smallest radius of the file, or 1 % of the size. A node at the position of its parent is merged into it
/// together with its children; so are twins, children of a node at the same position.
///
/// If coordinates are large relative to the size of the skeleton, positions become relative to the first
/// root: see local_origin().
///
/// Throws InvalidInput with the line: no nodes, a repeated id, a cycle, a number that is not finite or
/// exceeds 1e15. `source` names the file in messages. O(n log n), not recursive.
RepairResult repair(const std::vector<RawNode>& nodes, const std::string& source);

/// Converts cylinders to a valid skeleton: a tree of segments along their axes that preserves their radii.
///
/// * The child with the start closest to its parent's end continues the parent (the thickest on ties): both
/// axes are extended to the midpoint between that end and that start. It must start within a radius of the
/// end or, if it turns by less than 60 degrees, within two radii or inside the parent.
/// * Other children are laterals: they branch off at a new node on their parent's axis, or at its end if that
/// is closer than half a radius. The node is at the closest approach of the lateral's axis, extended
/// backwards, to the parent's axis, so that laterals that start on the surface of their parent branch off
/// without a bend; if the distance of the two axes exceeds the parent's radius, it is the closest point to
/// the lateral's start.
/// * The start of a lateral remains a separate node only if the straight line from the parent's axis to its
/// end would pass the start at more than half the lateral's radius. Gaps are bridged with the radius of the
/// cylinder behind them.
/// * Where the radius changes along an axis, both radii are kept, at the ends of a segment that is as long as
/// the change and at least as long as the smaller radius, but uses at most a third of each adjacent segment.
/// A lateral begins with its own radius (see Skeleton).
/// * A cylinder shorter than 1 % of its radius is removed; its children are attached to its parent.
RepairResult repair(const std::vector<RawCylinder>& cylinders, const std::string& source);

}  // namespace coppice
