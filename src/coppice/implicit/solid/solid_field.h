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
    float low;   ///< no value is less
    float high;  ///< no value is greater
};

/// A solid made ready for evaluation: maps are folded into the primitives, and the tree becomes a flat
/// program that runs over 64 points at a time with the widest vectors the machine has. Parts whose support
/// does not meet the box of those points are skipped, so that points which lie close together in the array
/// cost much less. What it says of a point does not depend, to the bit, on the other points of the call.
///
/// Satisfies FieldRef; the region is ignored. Making one is O(parts log parts). A copy is cheap.
class SolidField {
  public:
    explicit SolidField(const Solid& solid);  ///< Keeps the solid's parts alive.

    float level() const { return Solid::kSurface; }                        ///< that of solids
    const Box3& bounds() const { return bounds_; }                         ///< of the support
    const Box3& surface_bounds() const { return surface_bounds_; }         ///< of the solid
    Box3 bounds_at(float value) const { return solid_.bounds_at(value); }  ///< see Solid::bounds_at

    /// Value and gradient at each point. Thread safe.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;
    /// The values alone, in about half the time. 0 where a coordinate is not finite.
    void values(std::span<const Vec3> points, std::span<float> out) const;
    /// Bounds of the values in each box, never too narrow as long as the shapes' `steepness` is true; the
    /// smaller the box, the closer. Costs about twice what `values` does for as many points.
    void ranges(std::span<const Box3> boxes, std::span<ValueRange> out) const;

  private:
    Solid solid_;
    std::shared_ptr<const SolidProgram> program_;
    Box3 bounds_, surface_bounds_;
};

}  // namespace coppice
