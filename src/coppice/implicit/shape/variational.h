#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/shape/shape.h"

namespace coppice {

/// Options of Variational.
struct VariationalOptions {
    /// [size of the points' box] distance along a normal at which the value is prescribed.
    float offset = 0.01f;
    float margin = 0.1f;  ///< [size of the points' box] distance from the points' box at which the solid ends
};

/// Lists the members for front ends.
void list_fields(VariationalOptions& o, FieldList& list);

/// The smoothest closed surface through points with outward normals: f(p) = sum of w |p - center|^3 plus a
/// linear function is 0 at the points, and equal to the offset at points shifted along their normals by it
/// (less if another point would be nearer). Of all such functions f has the smallest integral of squared
/// third derivatives [Turk2002]. Of more than a thousand normals, those at a thousand evenly chosen points
/// are used.
///
/// The value is f divided by the length of its gradient, the distance near the surface to first order
/// [Taubin1994]; far from it, it is finite. Its gradient is the exact gradient of the value, and has unit
/// length only on the surface. Where points are missing the surface may extend; it ends at the margin around
/// the points' box.
class Variational final : public Shape {
  public:
    static constexpr std::size_t kMaxPoints = 5000;  ///< see the constructor

    /// Throws InvalidInput for less than 4 points or more than kMaxPoints, a different number of normals,
    /// points that coincide, normals without length, and points and normals that are all in one plane. A
    /// dense system: O(n^3); 1,000 points take 0.2 s of one core, 5,000 about 4 s and 290 MB.
    Variational(std::span<const Vec3> points, std::span<const Vec3> normals,
                const VariationalOptions& options = {}, const Context& ctx = {});

    Box3 bounds() const override { return box_; }

    /// O(n) per point.
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override;
    bool is_closed() const override { return true; }
    /// Not a true distance everywhere: no bound is known.
    float steepness() const override { return Box3::kInfinity; }

  private:
    std::vector<double> x_, y_, z_, weight_;  ///< in units of size_, relative to center_
    Vec3d linear_;
    double constant_ = 0;
    Vec3d center_;
    double size_ = 1;  ///< [m]
    Box3 box_;
};

}  // namespace coppice
