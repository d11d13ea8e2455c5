#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "coppice/base/kernel/kernel_math.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/subdivision/kernel/ray_kernel.h"

namespace coppice {

/// Value of the field at a point, in units of its level; numbers that are not finite count as far outside.
struct Reading {
    float ratio = 0;  ///< value / level
    float rise = 0;  ///< (ratio^(2/5) - 1) / its derivative by ratio: Newton's step is -rise / slope of ratio
    Vec3 gradient;   ///< [1/m] of the ratio
};

/// Returns the ratio of a sample.
COPPICE_HOST_DEVICE inline float read_ratio(const FieldSample& s, float per_level) {
    // Zero times a finite number is zero: one test for all four numbers.
    const float finite = 0 * s.value + 0 * s.gradient.x + 0 * s.gradient.y + 0 * s.gradient.z;
    const float value = finite == 0 ? s.value * per_level : 0.0f;
    return value > 0 ? value : 0.0f;
}

/// Returns the reading of a sample.
COPPICE_HOST_DEVICE inline Reading read_sample(const FieldSample& s, float per_level) {
    const float ratio = read_ratio(s, per_level);
    if (!(ratio > 0)) return {};
    return {ratio, kernel::newton_rise(ratio), s.gradient * per_level};
}

/// Returns Newton's step along the gradient on value^(2/5). `slope_squared` is that of the gradient, and not
/// zero.
COPPICE_HOST_DEVICE inline Vec3 newton_step(const Reading& here, float slope_squared, float damping) {
    return here.gradient * (-damping * (here.rise / slope_squared));
}

/// Anchor and direction of a vertex's ray; not usable if the two coincide or are not finite.
struct AnchorRay {
    Vec3 anchor;             ///< beginning of the ray
    Vec3 direction;          ///< from the anchor to the vertex
    bool is_usable = false;  ///< has a direction

    /// Creates the ray from an anchor through a vertex.
    COPPICE_HOST_DEVICE AnchorRay(Vec3 from, Vec3 through) : anchor(from), direction(through - from) {
        constexpr float kSameSpot = 1e-6f;  // anchor and vertex coincide within rounding
        const float size = length_squared(direction);
        is_usable = size > kSameSpot * kSameSpot * length_squared(anchor) && std::isfinite(size);
    }
};

/// Parameters of the steps along the gradient: see ProjectOptions.
struct WalkRule {
    float damping;      ///< of each step
    float tolerance;    ///< as a fraction of the distance from anchor to start
    float max_stretch;  ///< maximum distance from the anchor, in multiples of the initial one
    bool plain;         ///< Newton's method on the value itself, with steps of any length [Zhu2015]
};

/// Outcome of steps along the gradient; no_surface: they led into the anchor.
enum class WalkOutcome : std::uint8_t { running, converged, failed, no_surface };

/// A vertex that follows the gradient.
class GradientWalk {
  public:
    GradientWalk() = default;  ///< undefined position
    /// The direction is from the anchor to the vertex and not zero.
    COPPICE_HOST_DEVICE GradientWalk(Vec3 anchor, Vec3 direction)
        : anchor_(anchor),
          start_(anchor + direction),
          point_(start_),
          best_(start_),
          reach_(length(direction)) {}

    COPPICE_HOST_DEVICE Vec3 point() const { return point_; }  ///< current position

    /// Moves by one step from the reading at the current position.
    COPPICE_HOST_DEVICE WalkOutcome advance(const Reading& here, const WalkRule& rule) {
        constexpr float kShortest = 1.0f / 32;  // no point is inside down to here: the anchor does not help
        constexpr float kShrink = 0.35f;        // relative step to the anchor if there is no gradient
        constexpr float kLongestStep = 0.5f;    // in distances from the start to the anchor
        constexpr float kNearest = 0.25f;       // minimum share of the distance to the anchor after a step
        const float error = std::abs(here.ratio - 1);
        if (error < best_error_) {
            best_error_ = error;
            best_ = point_;
        }
        const float slope_squared = length_squared(here.gradient);
        const Vec3 from_anchor = point_ - anchor_;
        if (!(slope_squared > 0)) {
            if (rule.plain) return WalkOutcome::failed;
            if (length(from_anchor) < kShortest * reach_) return WalkOutcome::no_surface;
            point_ += from_anchor * (here.ratio >= 1 ? kShrink : -kShrink);
            return WalkOutcome::running;
        }
        Vec3 step = rule.plain ? here.gradient * (-rule.damping * (here.ratio - 1) / slope_squared)
                               : newton_step(here, slope_squared, rule.damping);
        const float size = length(step);
        if (!std::isfinite(size)) return WalkOutcome::failed;
        float longest = kLongestStep * reach_;
        if (dot(step, from_anchor) < 0)
            longest = kernel::smaller(longest, (1 - kNearest) * length(from_anchor));
        if (!rule.plain && size > longest) step *= longest / size;
        point_ += step;
        if (length(point_ - anchor_) > rule.max_stretch * reach_) return WalkOutcome::failed;
        const float left = (1 - rule.damping) * size + size * size / reach_;
        return left <= rule.tolerance * reach_ ? WalkOutcome::converged : WalkOutcome::running;
    }

    /// Returns the final position; a vertex that is still running has failed.
    COPPICE_HOST_DEVICE Vec3 result(WalkOutcome& outcome) const {
        if (outcome == WalkOutcome::running) outcome = WalkOutcome::failed;
        if (outcome == WalkOutcome::failed) return best_;
        return outcome == WalkOutcome::no_surface ? start_ : point_;
    }

  private:
    Vec3 anchor_, start_, point_, best_;
    float best_error_ = std::numeric_limits<float>::infinity();
    float reach_ = 0;
};

}  // namespace coppice
