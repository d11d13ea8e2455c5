#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A node as a file gives it, before anything is checked.
struct RawNode {
    std::int64_t id = 0;
    std::int64_t parent = -1;  ///< an id; any negative number, or an id that no node has, means a root
    Vec3d position;            ///< [m] world
    double radius = 0;         ///< [m]; <= 0 or NaN means missing
    std::uint32_t line = 0;    ///< line (or record) of the file, from 1; 0 = unknown
};

/// A cylinder of a quantitative structure model, before anything is checked.
struct RawCylinder {
    std::int64_t id = 0;
    std::int64_t parent = -1;
    Vec3d start, end;       ///< [m] world
    double radius = 0;      ///< [m]; <= 0 or NaN means missing
    std::uint32_t line = 0;
};

/// What `repair` mended, counted.
struct RepairReport {
    std::uint32_t reordered = 0;         ///< nodes that came before their parents
    std::uint32_t missing_parents = 0;   ///< nodes whose parent does not exist: they became roots
    std::uint32_t missing_radii = 0;     ///< zero, negative or unknown radii: interpolated along the chain
    std::uint32_t zero_length = 0;       ///< segments without length: merged into their parents
    std::uint32_t bridged_gaps = 0;      ///< cylinders that do not start at their parent's end
    std::uint32_t radius_jumps = 0;      ///< cylinders whose radius differs from their parent's
    std::uint32_t total() const { return reordered + missing_parents + missing_radii + zero_length; }
};

struct RepairResult {
    Skeleton skeleton;
    RepairReport report;
};

/// Makes a valid skeleton of raw nodes: puts parents first (otherwise keeping the order), makes roots of nodes without a
/// parent, interpolates missing radii linearly by length between the nearest known ones above and below along the chain
/// (else takes the nearest known, else the smallest of the file, else 1 % of the size), and merges zero-length segments. The
/// origin is the first root rounded to whole metres when coordinates are larger than 1,000 times the size, else zero.
/// Throws InvalidInput naming the line: no nodes, a repeated id, a cycle, a number that is not finite. O(n).
/// `source` names the file in messages.
RepairResult repair(const std::vector<RawNode>& nodes, const std::string& source);

/// The same for cylinders: each becomes a segment; a gap to the parent's end is bridged; a jump in radius keeps both
/// radii, one at each end of a short segment.
/// O(n).
RepairResult repair(const std::vector<RawCylinder>& cylinders, const std::string& source);

}  // namespace coppice
