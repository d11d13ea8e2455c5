#pragma once

#include "coppice/field/field_options.h"
#include "coppice/field/kernel/ball_chain.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A kernel with its parameter and weight.
struct KernelConstants {
    Kernel kernel = Kernel::quartic;  ///< the kernel
    double shape = 0;                 ///< support or width
    double weight = 0;                ///< line_weight of the kernel; unused for SCALIS
};

/// Returns the kernel specified by the options, which must be in range.
KernelConstants kernel_constants(const FieldOptions& options);

/// Evaluates one segment in double precision: for the calibration of constants, and as reference for the
/// vector code.
kernel::Sample<double> sample_segment(const KernelConstants& kernel,
                                      const kernel::SegmentConstants<double>& segment,
                                      kernel::Point<double> p);

/// Shape of a segment's start at a root.
enum class RootEnd {
    none,  ///< not at a root, or another segment has this end
    base,  ///< as specified by FieldOptions::root_extension
    round  ///< as at tips: other segments start at the root as well
};

/// Converts segments into constants, and computes the extension of a kernel's line beyond a tip.
class SegmentBuilder {
  public:
    /// Throws InvalidInput that names an option out of range.
    explicit SegmentBuilder(const FieldOptions& options);

    const KernelConstants& kernel() const { return kernel_; }  ///< the same for all segments

    /// [radii] Returns the length of the line beyond a tip of constant radius for which the surface ends 1
    /// radius beyond the tip.
    double tip_extension() const { return tip_extension_; }

    /// Returns the spacing of balls along the segments; unused for other kernels.
    const BallChain& chain() const { return chain_; }

    /// [radii] Returns the distance from a segment up to which it contributes.
    float reach() const { return reach_; }

    /// Returns the constants of a segment. `fallback` is the direction of a segment without length. For
    /// SCALIS the slope of the radius is limited to 0.4, keeping the radius of the thin end.
    kernel::SegmentConstants<float> build(const Segment& segment, Vec3 fallback, bool is_tip,
                                          RootEnd root) const;

    /// Returns the constants of a ball, for a tree of one node: a line of a twentieth radius with a weight
    /// that makes the value 1 at distance `radius`.
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
    double tip_extension_slope_ = 0;  ///< its derivative by the slope: SCALIS tapers beyond the node
    float reach_ = 0;
    BallChain chain_;
};

}  // namespace coppice
