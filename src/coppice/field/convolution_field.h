#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/candidate_lists.h"
#include "coppice/field/contact_lists.h"
#include "coppice/field/field_options.h"
#include "coppice/field/kernel/kernel_constants.h"
#include "coppice/field/kernel/segment_kernel.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A kernel integrated along every segment, scaled so that a long branch has the value 1 at its radius, also
/// if the radius is linear: the iso surface at value 1 is the surface of the tree, blended smoothly at nodes.
///
/// An axis is a chain of segments that follow the leader: a lateral starts a new axis. Segments of one axis
/// are added; axes are combined by a norm, F = (sum of F_axis^n)^(1/n) with n = options.blend [Ricci1973],
/// which preserves the radius of a lateral near its trunk. A single axis has the plain sum, as do all axes
/// for n = 1 and for global options.weights.
///
/// The radius is exact in the middle of branches; nodes swell, the outer side of bends sinks, and surfaces
/// that are close to each other blend (figures: docs/user/comparison.md). The line extends beyond tips and
/// roots, so that even a tree shorter than its radius has a surface. A tree of one node is a ball.
///
/// Values are >= 0, and 0 beyond the support of a compact kernel; with blend 8 the value of an axis below
/// 2^-15 is treated as 0. Rounding errors are below 1e-5 of the iso value near the surface.
///
/// [Zhu2015]: local weights, here in units of the radius; quartic and Cauchy use the radius at the point of
/// the axis closest to the sample, SCALIS varies it within the integral [Zanni2013].
class ConvolutionField {
  public:
    /// The skeleton must outlive the field. Throws InvalidInput that names an option out of range. O(n).
    ConvolutionField(const Skeleton& skeleton, const FieldOptions& options, const Context& ctx = {});
    ConvolutionField(Skeleton&&, const FieldOptions&, const Context& = {}) = delete;

    /// Multiplies the contribution of every segment, by child node: see global_weights. There must be one
    /// factor per node, >= 0 and finite.
    void scale_weights(std::span<const float> factors);

    /// Finds the relevant segments of each region (see find_candidates); replaces the previous regions.
    void set_regions(std::span<const FieldRegion> regions, const Context& ctx = {});

    /// The same for regions that are the tubes of one surface: in each, the value of its own branches is
    /// divided by options.contact times the value of its competing segments (see find_contacts) where that is
    /// above 1. Two branches that would pass through each other are thus separated by a gap [Cani1993].
    void set_regions(std::span<const FieldRegion> regions, const TubeTree& tubes, const Context& ctx = {});

    /// The same for boxes in which every segment with a support that touches them counts, connected or not:
    /// branches that intersect are merged into one body.
    void set_regions(std::span<const Box3> boxes, const Context& ctx = {});

    float level() const { return 1.0f; }  ///< iso value of the surface
    /// see set_regions
    std::uint32_t region_count() const { return static_cast<std::uint32_t>(lists_.first.size() - 1); }

    /// Returns the segments of a region by child node: grouped by axis, sorted in each; with blend 1: sorted.
    std::span<const std::uint32_t> candidates(std::uint32_t region) const;
    /// Returns the competing segments of a region; empty without tubes.
    std::span<const std::uint32_t> competitors(std::uint32_t region) const;

    /// Evaluates value and gradient at points of a region, from its list. Thread safe, no allocation. A
    /// sample depends only on its point and the list, not on the batch (bit-identical). Fastest for multiples
    /// of 16 points.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;

    /// The same from all segments, regardless of distance and connections; sorts them: O(points * segments).
    /// Reference for tests.
    void sample_everywhere(std::span<const Vec3> points, std::span<FieldSample> out) const;

    /// [radii] Returns the length of the line beyond a tip of constant radius for the default tip extension.
    float tip_extension() const { return static_cast<float>(builder_.tip_extension()); }

    /// Returns the constants of every segment, by child node; a root with children has weight 0.
    std::span<const kernel::SegmentConstants<float>> segments() const { return segments_; }

    /// Returns the axis of every segment, identified by the first of its child nodes.
    std::span<const std::uint32_t> axes() const { return axes_; }
    /// Returns the spacing of balls along the segments; only used by Kernel::balls.
    const BallChain& chain() const { return builder_.chain(); }
    const KernelConstants& kernel() const { return builder_.kernel(); }  ///< the kernel of all segments
    int blend() const { return blend_; }        ///< see FieldOptions; 1 for global weights
    float contact() const { return contact_; }  ///< see FieldOptions
    /// [radii] distance from a segment up to which it contributes.
    float reach() const { return builder_.reach(); }
    const CandidateLists& own_lists() const { return lists_; }               ///< candidates() of all regions
    const CandidateLists& competitor_lists() const { return competitors_; }  ///< competitors() of all regions

  private:
    void set_lists(CandidateLists lists, const Context& ctx);
    void sort_by_axis(std::span<std::uint32_t> segments) const;
    void sort_by_axis(CandidateLists& lists, const Context& ctx) const;
    void apply_contact(std::span<const std::uint32_t> competitors, std::span<const Vec3> points,
                       std::span<FieldSample> out) const;
    void sum(std::span<const std::uint32_t> segments, std::span<const Vec3> points,
             std::span<FieldSample> out) const;

    const Skeleton* skeleton_;
    SegmentBuilder builder_;
    std::vector<kernel::SegmentConstants<float>> segments_;
    std::vector<SegmentSupport> supports_;  ///< by child node
    std::vector<std::uint32_t> axes_;
    int blend_;
    float contact_;
    CandidateLists lists_;
    CandidateLists competitors_;
};

}  // namespace coppice
