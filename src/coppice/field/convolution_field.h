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

/// A kernel integrated along every segment, scaled so that a long branch has value 1 at its radius, also
/// where the radius runs linearly: the surface value = 1 is the skin of the tree, smoothly blended at nodes.
///
/// An axis is a chain of segments that follow the leader: a lateral starts a new one. Segments of one axis
/// add up; axes are combined by a norm, F = (sum of F_axis^n)^(1/n) with n = options.blend [Ricci1973], which
/// keeps a lateral's radius near its trunk. A single axis has its plain sum, and so has everything for n = 1
/// and where options.weights is global.
///
/// Radii are met in the middle of branches; nodes swell, the outer side of bends sinks, and surfaces that
/// pass close by blend (figures: docs/user/comparison.md). The line goes on beyond tips and roots, so
/// that even a tree shorter than its radius has a surface. A tree of one node is a ball.
///
/// Values are >= 0, and 0 beyond the support of a compact kernel; blend 8 takes an axis below 2^-15 for 0.
/// Errors of float are below 1e-5 of the level near the surface.
///
/// [Zhu2015]: local weights, here in units of the radius; quartic and Cauchy take the radius at the foot
/// point of the sample, SCALIS varies it within the integral [Zanni2013].
class ConvolutionField {
  public:
    /// The skeleton must outlive the field. Throws InvalidInput naming an option out of range. O(n).
    ConvolutionField(const Skeleton& skeleton, const FieldOptions& options, const Context& ctx = {});
    ConvolutionField(Skeleton&&, const FieldOptions&, const Context& = {}) = delete;

    /// Multiplies what every segment contributes, by lower node: see global_weights. Factors must be >= 0 and
    /// finite, one per node.
    void scale_weights(std::span<const float> factors);

    /// Finds the segments that matter in each region (see find_candidates); replaces former regions.
    void set_regions(std::span<const FieldRegion> regions, const Context& ctx = {});

    /// The same for regions that are the tubes of one surface: in each, the value of its own branches is
    /// divided by that of its rivals (see find_contacts) where options.contact times theirs is above 1. So
    /// two branches that would pass through each other meet at a wall with a gap instead [Cani1993].
    void set_regions(std::span<const FieldRegion> regions, const TubeTree& tubes, const Context& ctx = {});

    /// The same for boxes in which every segment counts whose support touches them, connected or not:
    /// branches that cross become one body.
    void set_regions(std::span<const Box3> boxes, const Context& ctx = {});

    float level() const { return 1.0f; }  ///< the surface is where the value is 1
    /// see set_regions
    std::uint32_t region_count() const { return static_cast<std::uint32_t>(lists_.first.size() - 1); }

    /// The segments of a region by lower node: axis by axis, ascending in each; blend 1: ascending.
    std::span<const std::uint32_t> candidates(std::uint32_t region) const;
    /// Those that the region's own are in contact with; none without tubes.
    std::span<const std::uint32_t> rivals(std::uint32_t region) const;

    /// Value and gradient at points of a region, from its list. Thread safe, no allocation. The bits of a
    /// sample depend on its point and the list alone, not on the batch. Cheapest for multiples of 16 points.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;

    /// The same from every segment, near or far, connected or not: O(points * segments), and sorts them. The
    /// oracle of tests.
    void sample_everywhere(std::span<const Vec3> points, std::span<FieldSample> out) const;

    /// [radii] How far the line goes on beyond a tip of constant radius when that is left to the field.
    float tip_extension() const { return static_cast<float>(builder_.tip_extension()); }

    /// What the kernels see of every segment, by lower node; a root with children has weight 0.
    std::span<const kernel::SegmentConstants<float>> segments() const { return segments_; }

    /// The axis of every segment, named by the highest of its lower nodes.
    std::span<const std::uint32_t> axes() const { return axes_; }
    /// How balls stand along the segments; unused for other kernels than Kernel::balls.
    const BallChain& chain() const { return builder_.chain(); }
    const KernelConstants& kernel() const { return builder_.kernel(); }  ///< the kernel of all segments
    int blend() const { return blend_; }              ///< see FieldOptions; 1 for global weights
    float contact() const { return contact_; }        ///< see FieldOptions
    float reach() const { return builder_.reach(); }  ///< [radii] how far from a segment its influence counts
    const CandidateLists& own_lists() const { return lists_; }     ///< candidates() of all regions
    const CandidateLists& rival_lists() const { return rivals_; }  ///< rivals() of all regions

  private:
    void set_lists(CandidateLists lists, const Context& ctx);
    void sort_by_axis(std::span<std::uint32_t> segments) const;
    void sort_by_axis(CandidateLists& lists, const Context& ctx) const;
    void apply_contact(std::span<const std::uint32_t> rivals, std::span<const Vec3> points,
                       std::span<FieldSample> out) const;
    void sum(std::span<const std::uint32_t> segments, std::span<const Vec3> points,
             std::span<FieldSample> out) const;

    const Skeleton* skeleton_;
    SegmentBuilder builder_;
    std::vector<kernel::SegmentConstants<float>> segments_;
    std::vector<SegmentSupport> supports_;  ///< by lower node
    std::vector<std::uint32_t> axes_;
    int blend_;
    float contact_;
    CandidateLists lists_;
    CandidateLists rivals_;
};

}  // namespace coppice
