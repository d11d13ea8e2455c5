#pragma once

#include <span>

#include "coppice/base/box.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Anything that knows how far a point is from it: a curve, a profile turned about an axis, a closed mesh.
/// `solid_of` makes a solid from it. A shape never changes after it was made.
class Shape {
  public:
    virtual ~Shape() = default;

    /// Holds the skeleton, or the closed surface itself: finite, not empty.
    virtual Box3 bounds() const = 0;

    /// value = distance to the shape [m], negative inside when the shape is closed; gradient = the gradient
    /// of the distance: pointing away from the shape, of unit length where differentiable. Thread safe; does
    /// not throw. What it says of a point does not depend on the other points of the call.
    virtual void distance(std::span<const Vec3> points, std::span<FieldSample> out) const = 0;

    /// Whether the distance is signed.
    virtual bool is_closed() const = 0;

    /// The gradient is nowhere longer than this; infinity where no bound is known. Whoever skips parts of
    /// space far from the surface relies on it: 1 for a true distance.
    virtual float steepness() const { return 1.0f; }
};

}  // namespace coppice
