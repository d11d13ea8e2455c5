#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The nearest of a fixed set of points: a kd-tree, so that no arrangement of the points makes it slow.
/// Refers to the points. Distances are those of the float positions in double precision; of equally near
/// points, any comes first, but always the same. Making it takes O(n log n), a query O(log n + k).
class KdTree {
  public:
    /// A point that was found.
    struct Nearest {
        std::uint32_t index = 0;  ///< of the point
        double squared = 0;       ///< [m^2] squared distance to it
    };

    /// At least one point, at most 2^32 - 1, all finite. Throws Cancelled.
    explicit KdTree(std::span<const Vec3> points, const Context& ctx = {});
    ~KdTree();                             ///< frees the tree, not the points
    KdTree(KdTree&&) noexcept;             ///< leaves a tree that may only be destroyed
    KdTree& operator=(KdTree&&) noexcept;  ///< as above

    /// The point that is nearest to p.
    Nearest nearest(Vec3 p) const;
    /// The points that are nearest to p, as many as there is room for, the nearest first. There must be as
    /// many.
    void nearest(Vec3 p, std::span<std::uint32_t> index, std::span<double> squared) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace coppice
