#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// Value and gradient of a scalar field at one point.
struct FieldSample {
    float value;    ///< greater than the iso value inside
    Vec3 gradient;  ///< [1/m] points inwards: the field decreases outwards
};

/// Reference to any scalar field with the surface value = level: greater inside, smaller outside. One
/// indirect call per batch.
///
/// `region` is the index of a region of space for which the field has prepared a list of relevant elements;
/// the caller passes the index that it received for that region. A field without such lists ignores it.
/// Samples must be thread safe.
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

    float level() const { return level_; }  ///< iso value of the surface
    /// Evaluates value and gradient at each point; `out` must have the same size.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        sample_(object_, region, points, out);
    }

  private:
    const void* object_;
    float level_;
    void (*sample_)(const void*, std::uint32_t, std::span<const Vec3>, std::span<FieldSample>);
};

}  // namespace coppice
