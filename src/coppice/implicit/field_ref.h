#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// Value and gradient of a scalar field at one point.
struct FieldSample {
    float value;    ///< greater than the level inside
    Vec3 gradient;  ///< [1/m] points inward: the field falls outward
};

/// Refers to any scalar field whose surface is value = level: inside above, outside below. One indirect call
/// per batch.
///
/// `region` names a part of space for which the field has prepared a list of what matters there; the caller
/// passes on the number it was given for that part. A field without such lists ignores it. Samples must be
/// thread safe.
class FieldRef {
  public:
    /// The field must outlive the reference, and have `level()` and `sample(region, points, out)`.
    template <class F>
    explicit FieldRef(const F& field)
        : object_(&field),
          level_(field.level()),
          sample_([](const void* object, std::uint32_t region, std::span<const Vec3> points,
                     std::span<FieldSample> out) {
              static_cast<const F*>(object)->sample(region, points, out);
          }) {}

    float level() const { return level_; }  ///< what the field is on its surface
    /// Value and gradient at each point, as many as `out` holds.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        sample_(object_, region, points, out);
    }

  private:
    const void* object_;
    float level_;
    void (*sample_)(const void*, std::uint32_t, std::span<const Vec3>, std::span<FieldSample>);
};

}  // namespace coppice
