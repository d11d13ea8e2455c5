#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// Kernel that is integrated along the segments; all are in units of the local radius, so that the field
/// scales with the tree.
enum class Kernel {
    quartic,  ///< compact; with support 1.5 the most accurate radius and the fastest
    cauchy,   ///< infinite support: soft joints, thin branches swell next to thick ones [Zhu2015]
    scalis,   ///< compact, radius varies within the integral [Zanni2013]; about 1.7 times the cost of quartic
    balls     ///< metaballs along the segments, each with the falloff of the quartic kernel [Ji2010]
};

template <>
struct EnumNames<Kernel> {
    static constexpr std::array<std::string_view, 4> names{"quartic", "cauchy", "scalis", "balls"};
};

/// Weights of the segments.
enum class Weights {
    local,  ///< each for a single infinite segment: in closed form, exact in the middle of branches
    global  ///< fitted together to points on the given surface (see global_weights)
};

template <>
struct EnumNames<Weights> {
    static constexpr std::array<std::string_view, 2> names{"local", "global"};
};

/// Options of the surface defined by the radii of a skeleton.
struct FieldOptions {
    Kernel kernel = Kernel::quartic;  ///< falloff with the distance
    float support = 1.5f;             ///< [radii] quartic, balls: radius of the support; 2 in [Zhu2015]
    float width = 2.0f;               ///< [1/radii] Cauchy: greater is sharper
    /// [radii] balls: maximum difference of the radii of a long branch; see ball_chain.
    float ball_bulge = 0.02f;
    /// [radii] Cauchy: maximum distance of segments in a region's list (2 % of the iso value).
    float reach = 4.0f;
    /// [radii] length of the line beyond tips; < 0: the surface ends 1 radius beyond the tip.
    float tip_extension = -1.0f;
    /// [radii] the same below roots, where a flat base is cut at the root; < 0: as at tips.
    float root_extension = 1.5f;
    int blend = 4;  ///< exponent n of (sum of F^n)^(1/n) over axes: 1 (plain sum, as Zhu2015), 2, 4 or 8
    float contact = 1.6f;  ///< branches that would pass through each other end where the other's value times
                           ///< this is above their own; greater values widen the gap; 0 = off: they blend
                           ///< where they are connected
    float radius_scale = 0;  ///< factor on all radii; round ends keep their length; 0 = 1, or the value
                             ///< required by the surface
    Weights weights = Weights::local;  ///< global uses blend 1
    int constraint_density = 12;       ///< mean number of fitted points per segment for global weights
    /// Number of times that global weights are averaged with those of adjacent segments.
    int weight_averaging = 0;
};

template <class Self, class Visitor>
requires SameOptions<Self, FieldOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"kernel", "Kernel that is integrated along the segments."}, o.kernel);
    visit(Field{"support",
                "Distance at which the influence of a segment ends, for the quartic kernel and balls.",
                Unit::radius, 1.1, 4},
          o.support);
    visit(Field{"kernel_width", "Sharpness of the Cauchy kernel, times the reciprocal of the radius.",
                Unit::none, 0.5, 8},
          o.width);
    visit(Field{"ball_bulge", "Maximum difference of the radii of a long branch, at and between balls.",
                Unit::radius, 0.0005, 0.5},
          o.ball_bulge);
    visit(Field{"reach", "Distance beyond which segments are ignored, for the Cauchy kernel.", Unit::radius,
                1.5, 32},
          o.reach);
    visit(Field{"tip_extension",
                "Length of the skeleton line beyond tips; a negative value makes round tips of one radius.",
                Unit::radius, -1, 4},
          o.tip_extension);
    visit(Field{"root_extension",
                "Length of the skeleton line below roots; a negative value makes round ends as at tips.",
                Unit::radius, -1, 4},
          o.root_extension);
    visit(Field{"blend",
                "Exponent that combines axes: 1 is the plain sum; 2, 4 and 8 make increasingly tight forks.",
                Unit::none, 1, 8},
          o.blend);
    visit(Field{"contact",
                "Strength with which branches that would cross repel each other; 0 disables the contact.",
                Unit::none, 0, 10},
          o.contact);
    visit(Field{"radius_scale",
                "Factor on all radii; 0 uses the factor at which rings of quads have the area of the "
                "specified circles, 1 places vertices at the radius.",
                Unit::none, 0, 2},
          o.radius_scale);
    visit(Field{"weights",
                "Weights of the segments: local weights treat each segment as if it were alone; global "
                "weights are fitted together to points on the given surface, by the plain sum of all "
                "segments (blend 1 is used)."},
          o.weights);
    visit(Field{"constraint_density", "Mean number of points per segment to which global weights are fitted.",
                Unit::none, 4, 256},
          o.constraint_density);
    visit(Field{"weight_averaging",
                "Number of times that fitted global weights are averaged with those of adjacent segments.",
                Unit::none, 0, 100},
          o.weight_averaging);
}

}  // namespace coppice
