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

/// Lists the members for front ends.
void list_fields(FieldOptions& o, FieldList& list);

}  // namespace coppice
