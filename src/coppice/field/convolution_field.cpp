#include "coppice/field/convolution_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/field/field_simd_internal.h"
#include "coppice/field/kernel/contact_kernel.h"
#include "coppice/field/list_kernel.h"
#include "coppice/field/skeleton_segments.h"

namespace coppice {
namespace {

constexpr std::size_t kConvolutionFieldGrain = 4096;
constexpr std::size_t kRegionGrain = 256;
constexpr std::size_t kContactBatch = 64;

/// Returns, by segment, the child node nearest to the root of the chain of leaders that contains the segment.
std::vector<std::uint32_t> find_axes(const Skeleton& skeleton) {
    std::vector<std::uint32_t> axes(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        const bool follows = !skeleton.is_root(n) && skeleton.leader(skeleton.parent(n)) == n;
        axes[n.index()] = follows ? axes[skeleton.parent(n).index()] : n.index();
    }
    return axes;
}

template <class Lists>
auto get_list(Lists& lists, std::size_t region) {
    return std::span(lists.segments)
        .subspan(lists.first[region], lists.first[region + 1] - lists.first[region]);
}

int checked_blend(const FieldOptions& options) {
    const int blend = options.blend;
    if (blend <= 0 || !std::has_single_bit(static_cast<unsigned>(blend)))
        throw InvalidInput(fmt::format("field: blend must be 1, 2, 4 or 8, but is {}", blend));
    return options.weights == Weights::global ? 1 : blend;
}

}  // namespace

ConvolutionField::ConvolutionField(const Skeleton& skeleton, const FieldOptions& options, const Context& ctx)
    : skeleton_(&skeleton),
      builder_(options),
      segments_(skeleton.size()),
      supports_(skeleton.size()),
      axes_(find_axes(skeleton)),
      blend_(checked_blend(options)),
      contact_(options.contact) {
    const SkeletonSegments segments(skeleton, builder_);
    parallel_for(ctx, skeleton.size(), kConvolutionFieldGrain, [&](std::size_t i) {
        segments_[i] = segments.build(NodeId(static_cast<std::uint32_t>(i)), skeleton.positions());
        supports_[i] = segment_support(segments_[i], builder_.reach());
    });
}

void ConvolutionField::scale_weights(std::span<const float> factors) {
    COPPICE_ASSERT(factors.size() == segments_.size());
    for (std::size_t i = 0; i < factors.size(); ++i) {
        COPPICE_ASSERT(factors[i] >= 0 && std::isfinite(factors[i]));
        segments_[i].weight *= factors[i];
    }
}

void ConvolutionField::set_regions(std::span<const FieldRegion> regions, const Context& ctx) {
    set_lists(find_candidates(*skeleton_, supports_, regions, ctx), ctx);
}

void ConvolutionField::set_regions(std::span<const Box3> boxes, const Context& ctx) {
    std::vector<SegmentSupport> supports = supports_;
    for (std::size_t i = 0; i < supports.size(); ++i) {
        if (segments_[i].weight == 0) supports[i].radius = 0;
    }
    set_lists(find_touching(supports, boxes, ctx), ctx);
}

void ConvolutionField::set_lists(CandidateLists lists, const Context& ctx) {
    lists_ = std::move(lists);
    competitors_ = {std::vector<std::uint64_t>(lists_.first.size(), 0), {}};
    sort_by_axis(lists_, ctx);
}

void ConvolutionField::set_regions(std::span<const FieldRegion> regions, const TubeTree& tubes,
                                   const Context& ctx) {
    if (contact_ == 0) return set_regions(regions, ctx);
    ContactLists contacts = find_contacts(*skeleton_, supports_, regions, tubes, ctx);
    lists_ = std::move(contacts.own);
    competitors_ = std::move(contacts.competitors);
    sort_by_axis(lists_, ctx);
    sort_by_axis(competitors_, ctx);
}

void ConvolutionField::sort_by_axis(CandidateLists& lists, const Context& ctx) const {
    if (blend_ == 1) return;
    parallel_for(ctx, lists.first.size() - 1, kRegionGrain,
                 [&](std::size_t i) { sort_by_axis(get_list(lists, i)); });
}

void ConvolutionField::sort_by_axis(std::span<std::uint32_t> segments) const {
    std::sort(segments.begin(), segments.end(), [this](std::uint32_t a, std::uint32_t b) {
        return axes_[a] != axes_[b] ? axes_[a] < axes_[b] : a < b;
    });
}

std::span<const std::uint32_t> ConvolutionField::candidates(std::uint32_t region) const {
    COPPICE_ASSERT(region < region_count());
    return get_list(lists_, region);
}

std::span<const std::uint32_t> ConvolutionField::competitors(std::uint32_t region) const {
    COPPICE_ASSERT(region < region_count());
    return get_list(competitors_, region);
}

void ConvolutionField::sample(std::uint32_t region, std::span<const Vec3> points,
                              std::span<FieldSample> out) const {
    sum(candidates(region), points, out);
    if (!competitors(region).empty()) apply_contact(competitors(region), points, out);
}

void ConvolutionField::apply_contact(std::span<const std::uint32_t> competitors, std::span<const Vec3> points,
                                     std::span<FieldSample> out) const {
    std::array<FieldSample, kContactBatch> batch;
    for (std::size_t begin = 0; begin < points.size(); begin += kContactBatch) {
        const std::size_t count = std::min(kContactBatch, points.size() - begin);
        sum(competitors, points.subspan(begin, count), std::span(batch).first(count));
        for (std::size_t i = 0; i < count; ++i) press(batch[i], contact_, out[begin + i]);
    }
}

void ConvolutionField::sample_everywhere(std::span<const Vec3> points, std::span<FieldSample> out) const {
    std::vector<std::uint32_t> all(segments_.size());
    std::iota(all.begin(), all.end(), 0u);
    if (blend_ > 1) sort_by_axis(all);
    sum(all, points, out);
}

void ConvolutionField::sum(std::span<const std::uint32_t> segments, std::span<const Vec3> points,
                           std::span<FieldSample> out) const {
    sum_segments(builder_.kernel(), {segments_.data(), segments, axes_.data(), blend_}, points, out);
}

}  // namespace coppice
