#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Which side of a solid's surface branches keep to.
/// The side of the surface on which segments are allowed.
enum class GuardSide { outside, inside };

template <>
struct EnumNames<GuardSide> {
    static constexpr std::array<std::string_view, 2> names{"outside", "inside"};
};

/// Which side of a surface is kept to, and how close to it.
struct GuardOptions {
    GuardSide side = GuardSide::outside;  ///< the side that is allowed
    float shell = 0;      ///< [field value] how far from the level the field may get on that side; 0 = any
                          ///< value, greater ones keep branches near the surface; in [0, 1e6]
    float clearance = 0;  ///< [m] least distance of an axis from the surface, to first order: value over
                          ///< slope; in [0, 1e4]
};

template <class Self, class Visitor>
requires SameOptions<Self, GuardOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"guard_side", "Side of the guarding solid that branches keep to"}, o.side);
    visit(Field{"guard_shell", "Difference from the level that branches keep within; 0 = no bound",
                Unit::none, 0, 1e6},
          o.shell);
    visit(Field{"guard_clearance", "Least distance of axes from the guarding surface", Unit::metre, 0, 1e4},
          o.clearance);
}

/// Keeps segments on one side of a surface, and where asked for, near it: marker points alone cannot, since
/// two of them on either side of a bulge pull a branch into it.
///
/// Segments are looked at in kSamples places along their length, with a little room to spare: what is clear
/// by the samples is clear all along, unless the surface has features thinner than a sixteenth of a segment.
/// Thread safe as the field is. The field must outlive the guard; it is sampled with region 0.
class Guard {
  public:
    static constexpr int kSamples = 16;  ///< places looked at along a segment

    /// Throws InvalidInput when an option is out of its range.
    explicit Guard(FieldRef field, const GuardOptions& options = {});

    /// Whether a point is allowed: one sample.
    bool allows(Vec3 p) const;

    /// Whether the whole segment is allowed, both ends included.
    bool allows_segment(Vec3 a, Vec3 b) const;

    /// The end of a segment of the given length that starts at `from`, which must be allowed, in the given
    /// unit direction; where that way is barred, slid along the surface. None where no way was found. Costs
    /// 16 samples, and as many again for each of at most 12 corrections.
    std::optional<Vec3> step(Vec3 from, Vec3 direction, float length) const;

  private:
    /// How far a place is from being barred, to first order, and the way farther off.
    struct Clearance {
        float distance;  ///< [m] negative: barred
        Vec3 away;
    };
    using Samples = std::array<Clearance, kSamples>;

    Clearance clearance_of(const FieldSample& sample) const;
    Samples samples(Vec3 a, Vec3 b) const;  ///< at t = 1/16, 2/16, ... 1

    FieldRef field_;
    GuardOptions options_;
};

}  // namespace coppice
