#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Side of a solid's surface on which segments are allowed.
enum class GuardSide { outside, inside };

template <>
struct EnumNames<GuardSide> {
    static constexpr std::array<std::string_view, 2> names{"outside", "inside"};
};

/// Options of Guard.
struct GuardOptions {
    GuardSide side = GuardSide::outside;  ///< the side that is allowed
    float shell = 0;  ///< [field value] maximum difference from the iso value on that side; 0 = unlimited,
                      ///< smaller values keep branches near the surface; in [0, 1e6]
    float clearance = 0;  ///< [m] minimum distance of an axis from the surface, to first order: value divided
                          ///< by slope; in [0, 1e4]
};

/// Lists the members for front ends.
void list_fields(GuardOptions& o, FieldList& list);

/// Keeps segments on one side of a surface, and optionally near it: marker points alone cannot, because two
/// of them on opposite sides of a bulge pull a branch into it.
///
/// Segments are tested at kSamples points along their length, with a small margin: a segment without an
/// excluded sample is clear along its whole length, unless the surface has features thinner than a sixteenth
/// of a segment. Thread safe if the field is. The field must outlive the guard; it is sampled with region 0.
class Guard {
  public:
    static constexpr int kSamples = 16;  ///< number of samples along a segment

    /// Throws InvalidInput if an option is out of range.
    explicit Guard(FieldRef field, const GuardOptions& options = {});

    /// Returns whether a point is allowed: one sample.
    bool allows(Vec3 p) const;

    /// Returns whether the whole segment is allowed, including both ends.
    bool allows_segment(Vec3 a, Vec3 b) const;

    /// Returns the end of a segment of the given length that starts at `from`, which must be allowed, in the
    /// given unit direction; if that direction is excluded, slides along the surface. Returns nullopt if no
    /// direction was found. Costs 16 samples, and 16 more for each of at most 12 corrections.
    std::optional<Vec3> step(Vec3 from, Vec3 direction, float length) const;

  private:
    /// Distance of a point to the excluded region, to first order, and the direction away from it.
    struct Clearance {
        float distance;  ///< [m] negative: excluded
        Vec3 away;
    };
    using Samples = std::array<Clearance, kSamples>;

    Clearance compute_clearance(const FieldSample& sample) const;
    Samples samples(Vec3 a, Vec3 b) const;  ///< at t = 1/16, 2/16, ... 1

    FieldRef field_;
    GuardOptions options_;
};

}  // namespace coppice
