#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A node as a file gives it, before anything is checked.
struct RawNode {
    std::int64_t id = 0;       ///< any, but each once
    std::int64_t parent = -1;  ///< an id; any negative number, or an id that no node has, means a root
    Vec3d position;            ///< [m] world
    double radius = 0;         ///< [m]; NaN or less than 1e-12 means missing
    std::uint32_t line = 0;    ///< line (or record) of the file, from 1; 0 = unknown
    StableId stable_id = {};   ///< see Skeleton::stable_id; all nodes have one, or none
};

/// A cylinder of a quantitative structure model, before anything is checked.
struct RawCylinder {
    std::int64_t id = 0;       ///< any, but each once
    std::int64_t parent = -1;  ///< as in RawNode
    Vec3d start;               ///< [m] world
    Vec3d end;                 ///< [m] world
    double radius = 0;         ///< [m]; NaN or less than 1e-12 means missing
    std::uint32_t line = 0;    ///< as in RawNode
};

/// What `repair` repaired, counted.
struct RepairReport {
    std::uint32_t reordered = 0;        ///< nodes that came before their parents
    std::uint32_t missing_parents = 0;  ///< nodes whose parent does not exist: they became roots
    std::uint32_t missing_radii = 0;    ///< zero, negative or unknown radii: interpolated along the chain
    std::uint32_t zero_length = 0;      ///< segments without length: merged into their parents
    std::uint32_t coincident = 0;  ///< nodes at the place of another child of their parent: merged into that
    std::uint32_t bridged_gaps =
        0;  ///< cylinders that start farther than their radius from where they attach
    std::uint32_t attached_inside = 0;  ///< cylinders that attach along their parent, not at its ends
    std::uint32_t radius_jumps =
        0;  ///< cylinders whose radius differs by more than 1 % from that of the one before
    /// What was wrong with the file; gaps and jumps lie in the nature of cylinders.
    std::uint32_t total() const {
        return reordered + missing_parents + missing_radii + zero_length + coincident;
    }
};

/// A valid skeleton, and what had to be repaired for it.
struct RepairResult {
    Skeleton skeleton;    ///< every node of the input but those merged
    RepairReport report;  ///< what was repaired
    /// of each node: index of the raw node, or of the raw cylinder that its segment belongs to
    std::vector<std::uint32_t> source;
};

/// Makes a valid skeleton of raw nodes. Parents are put first, otherwise the order is kept. Nodes without a
/// parent become roots. A missing radius is interpolated linearly by length between the nearest known ones
/// rootward and tipward (else it is the nearest known one, else the smallest of the file, else 1 % of the
/// size). A node at the place of its parent is merged into it and hands it its children; so are twins,
/// children of one node at the same place.
///
/// Positions become local to the first root where coordinates are large for the size of the skeleton: see
/// local_origin().
///
/// Throws InvalidInput naming the line: no nodes, a repeated id, a cycle, a number that is not finite or
/// beyond 1e15. `source` names the file in messages. O(n log n), no recursion.
RepairResult repair(const std::vector<RawNode>& nodes, const std::string& source);

/// The same for cylinders. Their axes become one tree of segments, and their radii stay true:
///
/// * The child that starts nearest to its parent's end continues it (the thickest on ties): both axes are
///   drawn to the middle between that end and that start. It must start within a radius of the end or, when
///   it turns by less than 60 degrees, within two radii or inside the parent.
/// * Other children are laterals: they leave from a new node on their parent's axis, or from its end when
///   that is nearer than half a radius. The node lies where the axis of the lateral, drawn backwards, comes
///   nearest to the parent's axis, so that laterals that start on the surface of their parent leave it
///   without a bend; where the two pass each other by more than the parent's radius, it is the foot point of
///   the lateral's start.
/// * The start of a lateral stays as a node of its own only where a straight way from the parent's axis to
///   its end would pass the start by more than half the lateral's radius. Gaps are bridged with the radius of
///   the cylinder behind them.
/// * Where the radius changes along an axis both radii stay, at the ends of a segment as long as the change
///   and at least as the lesser radius, but at most a third of each neighbour. A lateral starts with its own
///   radius (see Skeleton).
/// * A cylinder shorter than 1 % of its radius is left out; its children join its parent.
RepairResult repair(const std::vector<RawCylinder>& cylinders, const std::string& source);

}  // namespace coppice
