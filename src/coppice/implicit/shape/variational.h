#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/shape/shape.h"

namespace coppice {

/// How the surface through points is told from its inside, and where it ends.
struct VariationalOptions {
    float offset =
        0.01f;  ///< [size of the points' box] where along a normal the surface's distance is prescribed
    float margin = 0.1f;  ///< [size of the points' box] the solid ends this far around the points' box
};

template <class Self, class Visitor>
requires SameOptions<Self, VariationalOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"offset", "where along the normals the distance is prescribed, in sizes of the points' box",
                Unit::none, 1e-4, 0.2},
          o.offset);
    visit(Field{"margin", "how far around the points' box the solid ends, in sizes of that box", Unit::none,
                0, 1},
          o.margin);
}

/// The smoothest closed surface through points with outward normals: f(p) = sum of w |p - center|^3 plus a
/// linear function is 0 at the points, and the offset at points shifted along their normals by it (less where
/// that would come nearer to another point). Of all such functions f bends least: it has the least integral
/// of third derivatives [Turk2002]. Normals beyond a thousand count at a thousand points, evenly drawn.
///
/// The value is f over the length of its gradient, the distance near the surface to first order [Taubin1994];
/// far from it, it stays finite. Its gradient is that of the value, exact, and of unit length on the surface
/// alone. Where points are missing the surface may run on; it ends at the margin around the points' box.
class Variational final : public Shape {
  public:
    static constexpr std::size_t kMostPoints = 5000;  ///< see the constructor

    /// Throws InvalidInput for less than 4 points or more than kMostPoints, another number of normals, points
    /// that coincide, normals without length, and points and normals that all lie in one plane. A dense
    /// system: O(n^3); 1,000 points take 0.2 s of one core, 5,000 about 4 s and 290 MB.
    Variational(std::span<const Vec3> points, std::span<const Vec3> normals,
                const VariationalOptions& options = {}, const Context& ctx = {});

    Box3 bounds() const override { return box_; }

    /// O(n) a point.
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }
    /// Not a true distance everywhere: no bound is known.
    float steepness() const override { return Box3::kInfinity; }

    /// points and shifted points that the sum is over
    std::size_t center_count() const { return weight_.size(); }

  private:
    std::vector<double> x_, y_, z_, weight_;  ///< in units of size_, from center_
    Vec3d linear_;
    double constant_ = 0;
    Vec3d center_;
    double size_ = 1;  ///< [m]
    Box3 box_;
};

}  // namespace coppice
