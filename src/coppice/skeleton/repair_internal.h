#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/skeleton/raw.h"

namespace coppice::skeleton_internal {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kGreatest = 1e15;      // squares of lengths stay finite in single precision
constexpr double kLeastRadius = 1e-12;  // less means missing; cubes stay normal numbers in single precision

/// What links records to each other, by index.
struct Link {
    std::int64_t id, parent;
    std::uint32_t line;
};

/// Nodes whose parents come first.
struct NodeList {
    std::vector<std::uint32_t> parent;  // kNone for roots
    std::vector<Vec3d> position;        // world
    std::vector<double> radius;
    std::vector<StableId> stable_id;    // empty, or of every node
    std::vector<std::uint32_t> source;  // empty, or of every node: see RepairResult

    std::uint32_t size() const { return static_cast<std::uint32_t>(parent.size()); }
    std::uint32_t add(std::uint32_t parent_index, Vec3d p, double r) {
        parent.push_back(parent_index);
        position.push_back(p);
        radius.push_back(r);
        return size() - 1;
    }
};

/// "tree.swc, line 7", or the record's number where the line is unknown.
std::string place(const std::string& source, std::uint32_t line, std::size_t index);

void check_number(double value, const char* what, const std::string& source, std::uint32_t line,
                  std::size_t index);

/// The indices of parents (kNone for roots). Throws when an id is repeated; counts missing parents.
std::vector<std::uint32_t> find_parents(const std::vector<Link>& links, const std::string& source,
                                        RepairReport& report);

/// All indices, parents first, otherwise ascending. Throws on a cycle; counts what came before its parent.
std::vector<std::uint32_t> parents_first(const std::vector<std::uint32_t>& parent,
                                         const std::vector<Link>& links, const std::string& source,
                                         RepairReport& report);

/// Fills radii that are missing (< kLeastRadius or NaN). Records are in order, parents first; `step` is each
/// one's distance to its parent, `size` that of everything. Returns how many were filled.
std::uint32_t fill_radii(const std::vector<std::uint32_t>& parent, const std::vector<double>& step,
                         double size, std::vector<double>& radius);

/// The diagonal of the points' box.
double extent(const std::vector<Vec3d>& points);

/// Merges what coincides, which it counts in addition, and moves to the local origin.
RepairResult assemble(const NodeList& nodes, const RepairReport& report);

}  // namespace coppice::skeleton_internal
