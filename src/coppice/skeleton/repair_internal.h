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
#include "coppice/base/id.h"
#include "coppice/skeleton/raw.h"

namespace coppice::skeleton_internal {

constexpr double kMax = 1e15;         // squares of lengths are finite in single precision
constexpr double kMinRadius = 1e-12;  // smaller means missing; cubes are normal numbers in single precision

/// Ids that link records, by index.
struct Link {
    std::int64_t id, parent;
    std::uint32_t line;
};

/// Nodes, parents before their children.
struct NodeList {
    std::vector<std::uint32_t> parent;  // kNoIndex for roots
    std::vector<Vec3d> position;        // in world space
    std::vector<double> radius;
    std::vector<StableId> stable_id;    // empty, or one for every node
    std::vector<std::uint32_t> source;  // empty, or one for every node: see RepairResult

    std::uint32_t size() const { return static_cast<std::uint32_t>(parent.size()); }
    std::uint32_t add(std::uint32_t parent_index, Vec3d p, double r) {
        parent.push_back(parent_index);
        position.push_back(p);
        radius.push_back(r);
        return size() - 1;
    }
};

/// Returns "tree.swc, line 7", or the number of the record if the line is unknown.
std::string place(const std::string& source, std::uint32_t line, std::size_t index);

void check_number(double value, const char* subject, const std::string& source, std::uint32_t line,
                  std::size_t index);

/// Returns the indices of parents (kNoIndex for roots). Throws if an id is repeated; counts missing parents.
std::vector<std::uint32_t> find_parents(const std::vector<Link>& links, const std::string& source,
                                        RepairReport& report);

/// Returns all indices, parents first, otherwise ascending. Throws on a cycle; counts nodes that preceded
/// their parents.
std::vector<std::uint32_t> parents_first(const std::vector<std::uint32_t>& parent,
                                         const std::vector<Link>& links, const std::string& source,
                                         RepairReport& report);

/// Fills missing radii (< kMinRadius or NaN). Records are in order, parents first; `step` is the distance
/// of each to its parent, `size` the total extent. Returns the number of filled radii.
std::uint32_t fill_radii(const std::vector<std::uint32_t>& parent, const std::vector<double>& step,
                         double size, std::vector<double>& radius);

/// Returns the diagonal of the bounding box.
double extent(const std::vector<Vec3d>& points);

/// Merges coincident nodes, adds their numbers to the report, and moves the positions to the local origin.
RepairResult assemble(const NodeList& nodes, const RepairReport& report);

}  // namespace coppice::skeleton_internal
