#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What tells when a node of a tree came.
enum class Age {
    length,  ///< the way from the root: all branches grow at one speed
    order  ///< the order of the nodes, as of space colonization: there are four times as many after twice the
           ///< time
};

template <>
struct EnumNames<Age> {
    static constexpr std::array<std::string_view, 2> names{"length", "order"};
};

/// How a tree grows up.
struct GrowingOptions {
    Age age = Age::length;  ///< when nodes come
    /// A branch with a part of its later length above it has this root of that part of its later radius; in
    /// [1, 10].
    float exponent = 2.5f;
};

template <class Self, class Visitor>
requires SameOptions<Self, GrowingOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"age",
                "what tells when nodes come: the way from the root, or their order, as that of grown trees"},
          o.age);
    visit(Field{"exponent", "of the pipe model by which branches thicken: greater is earlier", Unit::none, 1,
                10},
          o.exponent);
}

/// A tree at all moments of its growth. Every segment grows from its parent on, tips taper, and branches
/// thicken with the length of what they bear, as pipes do; in the end each has the radius that it has in the
/// skeleton.
class GrowingTree {
  public:
    /// Throws InvalidInput where an option is out of range. The skeleton must outlive this. O(n).
    GrowingTree(const Skeleton& skeleton, const GrowingOptions& options = {});

    /// The tree after a part of its time in [0, 1]: at 1 the skeleton, at 0 its roots with what just shows of
    /// them. Nodes keep their stable ids and their order. O(n).
    Skeleton at(double part) const;

  private:
    const Skeleton& skeleton_;
    double exponent_;
    float least_radius_;
    std::vector<double> start_, end_;  ///< by node: when its segment begins to grow, and when it is whole
    std::vector<double> above_;        ///< [m] by node: of its segment and all above it
};

}  // namespace coppice
