#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Closest-point queries in a fixed set of points: a kd-tree, which is fast for any arrangement of the
/// points. Refers to the points. Distances are those of the float positions in double precision; the order of
/// equally close points is arbitrary but deterministic. Construction costs O(n log n), a query O(log n + k).
class KdTree {
  public:
    /// Result of a query.
    struct Nearest {
        std::uint32_t index = 0;  ///< index of the point
        double squared = 0;       ///< [m^2] squared distance to it
    };

    /// Builds the tree. Requires 1 to 2^32 - 1 finite points. Throws Cancelled.
    explicit KdTree(std::span<const Vec3> points, const Context& ctx = {});
    ~KdTree();                             ///< frees the tree, not the points
    KdTree(KdTree&&) noexcept;             ///< leaves a tree that may only be destroyed
    KdTree& operator=(KdTree&&) noexcept;  ///< as above

    /// Returns the point closest to p.
    Nearest nearest(Vec3 p) const;
    /// Finds as many of the points closest to p as the spans have elements, closest first. There must be at
    /// least as many points.
    void nearest(Vec3 p, std::span<std::uint32_t> index, std::span<double> squared) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace coppice
