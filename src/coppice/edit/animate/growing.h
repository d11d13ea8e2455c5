#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Quantity that determines when a node appears.
enum class Age {
    length,  ///< path length from the root: all branches grow at the same speed
    order  ///< node order, as created by space colonization: the number of nodes grows with the square of the
           ///< time
};

template <>
struct EnumNames<Age> {
    static constexpr std::array<std::string_view, 2> names{"length", "order"};
};

/// Options of GrowingTree.
struct GrowingOptions {
    Age age = Age::length;  ///< determines when nodes appear
    /// Exponent of the pipe model: a branch that carries the fraction f of its final length has f^(1 /
    /// exponent) of its final radius; in [1, 10].
    float exponent = 2.5f;
};

/// Lists the members for front ends.
void list_fields(GrowingOptions& o, FieldList& list);

/// A tree at every moment of its growth. Each segment grows from its parent, tips taper, and branches thicken
/// by the pipe model with the length that they carry. At the end each node has the radius of the skeleton.
class GrowingTree {
  public:
    /// Throws InvalidInput if an option is out of range. The skeleton must outlive this object. O(n).
    GrowingTree(const Skeleton& skeleton, const GrowingOptions& options = {});

    /// Returns the tree after the fraction `part` in [0, 1] of its growth: the skeleton at 1, and its roots
    /// with a minimal first segment at 0. Nodes keep their stable ids and their order. O(n).
    Skeleton at(double part) const;

  private:
    const Skeleton& skeleton_;
    double exponent_;
    float min_radius_;
    std::vector<double> start_, end_;  ///< by node: times at which its segment begins and ends to grow
    std::vector<double> above_;        ///< [m] by node: total length of its segment and its descendants
};

}  // namespace coppice
