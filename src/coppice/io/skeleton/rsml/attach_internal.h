#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/io/skeleton/rsml/document_internal.h"

namespace coppice::rsml {

/// A place on a polyline: `t` of the way from point `point` to the next one.
struct LinePlace {
    std::uint32_t point = 0;
    double t = 0;  ///< from 0 to less than 1
};

/// Finds the place of a polyline that is nearest to a point. The line may not be empty, and must outlive
/// this.
class NearestOnLine {
  public:
    explicit NearestOnLine(std::span<const Vec3d> line);  ///< O(n)

    /// In roots O(log n). However the line is knotted, a search ends after a fixed number of steps, with the
    /// nearest place that it met.
    LinePlace operator()(Vec3d p) const;

  private:
    struct Box {
        Vec3d low, high;
        double distance_squared(Vec3d p) const;
    };
    std::span<const Vec3d> line_;
    std::uint32_t leaves_ = 1;  // a power of two
    std::vector<Box> boxes_;    // a heap: 1 holds all, 2i and 2i + 1 the halves of i
};

/// Where every root but the first ones leaves its parent; by index of the root. A parent-node is followed
/// where it names a point of the parent, counted from 0 or from 1 as fits the file; otherwise it is the place
/// nearest to the root's first point. `parent` is of each root the nearest one about it that has points, or
/// kNone.
std::vector<LinePlace> attach_roots(const Document& document, std::span<const std::uint32_t> parent);

}  // namespace coppice::rsml
