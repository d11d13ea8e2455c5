#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// What is integrated along the segments; all are in units of the local radius, so that a tree may be scaled.
enum class Kernel {
    quartic,  ///< compact; with support 1.5 the most radius-true and the fastest
    cauchy,   ///< infinite support: soft joints, thin branches swell beside thick ones [Zhu2015]
    scalis,   ///< compact, radius varies within the integral [Zanni2013]; about 1.7 times the cost of quartic
    balls     ///< metaballs along the segments, each falling off as the quartic kernel does [Ji2010]
};

template <>
struct EnumNames<Kernel> {
    static constexpr std::array<std::string_view, 4> names{"quartic", "cauchy", "scalis", "balls"};
};

/// How much each segment counts.
enum class Weights {
    local,  ///< each as if it were alone and endless: in closed form, exact in the middle of branches
    global  ///< those that fit points on the given surface best, all together (see global_weights)
};

template <>
struct EnumNames<Weights> {
    static constexpr std::array<std::string_view, 2> names{"local", "global"};
};

/// What surface the radii of a skeleton mean.
struct FieldOptions {
    Kernel kernel = Kernel::quartic;  ///< how influence falls with distance
    float support = 1.5f;  ///< [radii] quartic, balls: distance at which influence ends; 2 is Zhu2015's
    float width = 2.0f;    ///< [1/radii] Cauchy: greater is sharper
    float ball_bulge =
        0.02f;  ///< [radii] balls: so much radii of a long branch differ at most; see ball_chain
    float reach =
        4.0f;  ///< [radii] Cauchy: farther segments are left out of a region's list (2 % of the level)
    float tip_extension =
        -1.0f;  ///< [radii] skeleton line beyond tips; < 0: so long that the surface ends 1 radius beyond
    float root_extension =
        1.5f;       ///< [radii] the same below roots, where a flat base is cut at the root; < 0: as at tips
    int blend = 4;  ///< exponent n of (sum of F^n)^(1/n) over axes: 1 (plain sum, as Zhu2015), 2, 4 or 8
    float contact =
        1.6f;  ///< branches that would pass through each other stop where the other's value times this is
               ///< above theirs; greater leaves a wider gap; 0 = off: they blend where they are connected
    float radius_scale =
        0;  ///< of all radii, while round ends reach as far as without it; 0 = 1, or as the surface needs it
    Weights weights = Weights::local;  ///< global takes blend for 1
    int constraint_density = 12;       ///< points per segment, on average, that global weights are fitted to
    int weight_averaging = 0;  ///< times that global weights become the mean of theirs and adjacent ones
};

template <class Self, class Visitor>
requires SameOptions<Self, FieldOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"kernel", "what is integrated along the segments"}, o.kernel);
    visit(
        Field{"support", "quartic kernel and balls: distance at which influence ends", Unit::radius, 1.1, 4},
        o.support);
    visit(Field{"width", "Cauchy kernel: sharpness, times the reciprocal of the radius", Unit::none, 0.5, 8},
          o.width);
    visit(Field{"ball_bulge", "balls: radii of a long branch, at and between balls, differ by this at most",
                Unit::radius, 0.0005, 0.5},
          o.ball_bulge);
    visit(Field{"reach", "Cauchy kernel: segments farther away are left out", Unit::radius, 1.5, 32},
          o.reach);
    visit(
        Field{"tip_extension", "length of the skeleton line beyond tips; negative: round tips of one radius",
              Unit::radius, -1, 4},
        o.tip_extension);
    visit(Field{"root_extension", "length of the skeleton line below roots; negative: round as tips",
                Unit::radius, -1, 4},
          o.root_extension);
    visit(
        Field{"blend",
              "exponent with which axes are combined: 1 is the plain sum, 2, 4 and 8 have ever tighter forks",
              Unit::none, 1, 8},
        o.blend);
    visit(Field{"contact", "how strongly branches that would cross push each other back; 0 = not at all",
                Unit::none, 0, 10},
          o.contact);
    visit(
        Field{"radius_scale",
              "factor on all radii; 0 = that at which rings of quads have the area of the circles meant, 1 = "
              "vertices at the radius",
              Unit::none, 0, 2},
        o.radius_scale);
    visit(Field{"weights",
                "how much each segment counts: local = as if it were alone; global = as fits points "
                "on the given surface best, by the plain sum of all segments (blend is taken for 1)"},
          o.weights);
    visit(Field{"constraint_density", "points per segment, on average, that global weights are fitted to",
                Unit::none, 4, 256},
          o.constraint_density);
    visit(Field{"weight_averaging",
                "times that global weights, once fitted, become the mean of their own and of those of "
                "adjacent segments",
                Unit::none, 0, 100},
          o.weight_averaging);
}

}  // namespace coppice
