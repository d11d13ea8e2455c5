#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/io_skeleton/rsml/document_internal.h"

namespace coppice::rsml {

/// A position on a polyline: parameter `t` between the points `point` and `point` + 1.
struct LinePlace {
    std::uint32_t point = 0;
    double t = 0;  ///< in [0, 1)
};

/// Finds the closest point of a polyline. The line must not be empty and must outlive this object.
class NearestOnLine {
  public:
    explicit NearestOnLine(std::span<const Vec3d> line);  ///< O(n)

    /// O(log n) for typical roots. For tangled lines the search ends after a fixed number of steps with the
    /// closest point found.
    LinePlace operator()(Vec3d p) const;

  private:
    struct Box {
        Vec3d low, high;
        double distance_squared(Vec3d p) const;
    };
    std::span<const Vec3d> line_;
    std::uint32_t leaves_ = 1;  // a power of two
    std::vector<Box> boxes_;    // a heap: 1 bounds all points, 2i and 2i + 1 the halves of i
};

/// Returns the position at which every root except the first ones branches off its parent; by index of the
/// root. A parent-node is used if it specifies a point of the parent, counted from 0 or from 1 as fits the
/// file; otherwise the position is the closest point to the first point of the root. `parent` contains for
/// each root its closest ancestor that has points, or kNoIndex.
std::vector<LinePlace> attach_roots(const Document& document, std::span<const std::uint32_t> parent);

}  // namespace coppice::rsml
