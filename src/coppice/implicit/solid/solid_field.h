#pragma once

#include <memory>
#include <span>

#include "coppice/base/box.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

struct SolidProgram;

/// Bounds of a field's values within a box.
struct ValueRange {
    float low;   ///< lower bound
    float high;  ///< upper bound
};

/// A solid compiled for evaluation: maps are folded into the primitives, and the tree becomes a flat program
/// that processes 64 points at a time with the widest vectors of the machine. Parts with a support that does
/// not meet the box of those points are skipped, so that points that are close together in the array are much
/// cheaper. The value at a point does not depend on the other points of the call (bit-identical).
///
/// Satisfies FieldRef; the region is ignored. Construction is O(parts log parts). A copy is cheap.
class SolidField {
  public:
    explicit SolidField(const Solid& solid);  ///< Keeps the solid's parts alive.

    float level() const { return Solid::kSurface; }                        ///< iso value of solids
    const Box3& bounds() const { return bounds_; }                         ///< box of the support
    const Box3& surface_bounds() const { return surface_bounds_; }         ///< box of the solid
    Box3 bounds_at(float value) const { return solid_.bounds_at(value); }  ///< see Solid::bounds_at

    /// Evaluates value and gradient at each point. Thread safe.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;
    /// Evaluates only the values, in about half the time. 0 if a coordinate is not finite.
    void values(std::span<const Vec3> points, std::span<float> out) const;
    /// Computes bounds of the values in each box, which are valid if the shapes' `steepness` is valid;
    /// tighter for smaller boxes. Costs about twice as much as `values` for the same number of points.
    void ranges(std::span<const Box3> boxes, std::span<ValueRange> out) const;

  private:
    Solid solid_;
    std::shared_ptr<const SolidProgram> program_;
    Box3 bounds_, surface_bounds_;
};

}  // namespace coppice
