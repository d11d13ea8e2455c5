#pragma once

#include <span>

#include "coppice/base/box.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Any object with a distance function: a curve, a profile rotated about an axis, a closed mesh. `make_solid`
/// makes a solid from it. A shape is immutable.
class Shape {
  public:
    virtual ~Shape() = default;

    /// Returns the box of the skeleton, or of the closed surface itself: finite, not empty.
    virtual Box3 bounds() const = 0;

    /// Evaluates value = distance to the shape [m], negative inside if the shape is closed, and its gradient:
    /// pointing away from the shape, of unit length where differentiable. Thread safe; does not throw. The
    /// value at a point does not depend on the other points of the call.
    virtual void distance(std::span<const Vec3> points, std::span<FieldSample> out) const = 0;

    /// Returns whether the distance is signed.
    virtual bool is_closed() const = 0;

    /// Returns an upper bound of the length of the gradient; infinity if no bound is known. Required for
    /// skipping regions of space far from the surface: 1 for a true distance.
    virtual float steepness() const { return 1.0f; }
};

}  // namespace coppice
