#pragma once

#include "coppice/field/field_options.h"
#include "coppice/field/kernel/ball_chain.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A kernel with its parameter, ready for use.
struct KernelConstants {
    Kernel kernel = Kernel::quartic;  ///< which one
    double shape = 0;                 ///< support or width
    double weight = 0;                ///< line_weight of the kernel; unused for SCALIS
};

/// The kernel that the options name; they must be in range.
KernelConstants kernel_constants(const FieldOptions& options);

/// One segment in double precision: what the constants are calibrated with, and the reference for the vector
/// code.
kernel::Sample<double> sample_segment(const KernelConstants& kernel,
                                      const kernel::SegmentConstants<double>& segment,
                                      kernel::Point<double> p);

/// How a segment begins at a root.
enum class RootEnd {
    none,  ///< it does not, or another one has this end
    base,  ///< as FieldOptions::root_extension says
    round  ///< as at tips: other segments leave the root as well
};

/// Turns segments into constants, and knows how far a kernel's line has to go on beyond a tip.
class SegmentBuilder {
  public:
    /// Throws InvalidInput naming an option out of range.
    explicit SegmentBuilder(const FieldOptions& options);

    const KernelConstants& kernel() const { return kernel_; }  ///< the same for all segments

    /// [radii] Length of line beyond a tip of constant radius so that the surface ends 1 radius beyond it.
    double tip_extension() const { return tip_extension_; }

    /// How balls stand along the segments; unused for other kernels.
    const BallChain& chain() const { return chain_; }

    /// [radii] How far from a segment its influence counts.
    float reach() const { return reach_; }

    /// `fallback` is the direction of a segment without length. Jumps in radius are made less steep where
    /// SCALIS needs it: at most 0.4, held at the thin end.
    kernel::SegmentConstants<float> build(const Segment& segment, Vec3 fallback, bool is_tip,
                                          RootEnd root) const;

    /// A ball of its own, for a tree of one node: a line of a twentieth radius with the weight that makes the
    /// value 1 at distance `radius`.
    kernel::SegmentConstants<float> build_ball(Vec3 center, float radius) const;

  private:
    double calibrate_tip(double slope) const;
    double slope_weight(double slope) const;
    int ball_count(const kernel::SegmentConstants<float>& segment) const;
    float extension(float option, float radius, float slope_outward) const;

    FieldOptions options_;
    float radius_scale_ = 1;
    KernelConstants kernel_;
    double tip_extension_ = 0;
    double tip_extension_slope_ = 0;  ///< its change with the slope: SCALIS tapers on beyond the node
    float reach_ = 0;
    BallChain chain_;
};

}  // namespace coppice
