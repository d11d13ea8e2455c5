#pragma once

#include <cstdint>
#include <span>

#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/cuda/lists/box_tree_stages_internal.h"
#include "coppice/cuda/lists/list_kernels_internal.h"

namespace coppice::cuda {

/// Computes the supports of segments; segments without weight have no support.
struct SupportTouching {
    std::span<const DeviceSegment> segments;
    float reach;  ///< see ConvolutionField
    std::span<DeviceSupport> out;
    std::span<Box3> boxes;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        SegmentSupport support = segment_support(segments[s].constants, reach);
        if (segments[s].constants.weight == 0) support.radius = 0;
        out[s].capsule = support;
        boxes[s] = support.box;
    }
};

/// Computes the sorting keys of segments.
struct KeyByAxis {
    std::span<const DeviceSegment> segments;
    bool by_axis;  ///< otherwise by number
    std::span<std::uint32_t> key, segment;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        key[s] = by_axis ? segments[s].axis : 0;
        segment[s] = s;
    }
};

/// Computes the rank of every segment.
struct RankSegments {
    std::span<const std::uint32_t> in_order;
    std::span<std::uint32_t> rank;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { rank[in_order[i]] = i; }
};

/// Finds all segments with a support that touches the box of a region.
struct TouchingSearch {
    std::span<const Box3> boxes;  ///< of regions
    std::span<const DeviceSupport> capsules;
    DeviceBoxTree tree;  ///< tree of their boxes

    /// Calls visit(segment).
    template <class Visit>
    COPPICE_HOST_DEVICE void run(std::uint32_t region, const Visit& visit) const {
        const RegionProbe probe(boxes[region]);
        tree.visit_overlapping(probe.box, [&](std::uint32_t s) {
            if (capsules[s].capsule.radius > 0 && probe.touches(capsules[s])) visit(s);
            return true;
        });
    }
};

/// Counts the segments of each region.
struct CountTouching {
    TouchingSearch search;
    std::uint32_t limit;
    std::span<std::uint32_t> count;
    std::span<std::uint32_t> cut;  ///< one number: 1 if there are more than the limit
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t found = 0;
        search.run(r, [&](std::uint32_t) { ++found; });
        if (found > limit) raise_to(cut[0], 1u);
        count[r] = found;
    }
};

/// Lists the segments of each region in order.
struct FillTouching {
    TouchingSearch search;
    std::span<const std::uint32_t> rank, in_order;  ///< of segments
    std::span<const std::uint32_t> first;           ///< of every region, plus the end
    std::span<std::uint32_t> segments;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t* const list = segments.data() + first[r];
        std::uint32_t count = 0;
        search.run(r, [&](std::uint32_t s) { list[count++] = rank[s]; });
        sort_ranks(list, count);
        for (std::uint32_t k = 0; k < count; ++k) list[k] = in_order[list[k]];
    }
};

/// The segments of a field on an executor, without regions.
struct DeviceSegments {
    std::span<const DeviceSegment> segments;  ///< by lower node
    float reach = 0;                          ///< see ConvolutionField
    int blend = 1;                            ///< see FieldOptions
    float contact = 0;                        ///< see FieldOptions
};

/// Copies the segments of a field.
template <class Exec>
DeviceSegments upload_segments(Exec& exec, const ConvolutionField& field) {
    return {exec.upload(std::span<const DeviceSegment>(device_segments(field))), field.reach(), field.blend(),
            field.contact()};
}

/// Segments in the order of lists, and the rank of each.
struct SegmentOrder {
    std::span<const std::uint32_t> in_order, rank;
};
template <class Exec>
SegmentOrder order_segments(Exec& exec, const DeviceSegments& field) {
    const std::size_t count = field.segments.size();
    const auto key = exec.template array<std::uint32_t>(count);
    const auto in_order = exec.template array<std::uint32_t>(count);
    const auto rank = exec.template array<std::uint32_t>(count);
    exec.each("sort segments", count, KeyByAxis{field.segments, field.blend > 1, key, in_order});
    exec.sort_pairs(key, in_order);
    exec.each("sort segments", count, RankSegments{in_order, rank});
    return {in_order, rank};
}

/// Creates the field with these regions, with boxes on the executor: the same lists as set_regions(), except
/// that GPUs round differently, so that a segment that barely touches a box may be in only one of them.
/// Throws DeviceError if a list has more than `longest` segments: see longest_list(). O((segments + regions)
/// log n + lists). Waits.
template <class Exec>
FieldArrays set_regions(Exec& exec, const DeviceSegments& field, std::span<const Box3> boxes,
                        std::size_t longest) {
    const std::size_t regions = boxes.size(), count = field.segments.size();
    const auto capsules = exec.template array<DeviceSupport>(count);
    const auto of_segments = exec.template array<Box3>(count);
    exec.each("support segments", count, SupportTouching{field.segments, field.reach, capsules, of_segments});
    const std::span<const Box3> known = of_segments;
    const TouchingSearch search{boxes, capsules, box_tree(exec, known, box_order(exec, known))};
    const SegmentOrder order = order_segments(exec, field);

    const auto first = exec.template array<std::uint32_t>(regions + 1);
    const auto cut = exec.template array<std::uint32_t>(1);
    exec.clear(cut);
    exec.clear(first);
    exec.each("count touching", regions,
              CountTouching{search, static_cast<std::uint32_t>(longest), first, cut});
    exec.exclusive_scan(std::span<const std::uint32_t>(first), first);
    std::uint32_t entries = 0, is_cut = 0;
    exec.download(std::span<const std::uint32_t>(first).last(1), std::span(&entries, 1));
    exec.download(std::span<const std::uint32_t>(cut), std::span(&is_cut, 1));
    if (is_cut != 0) throw DeviceError("too many segments meet in one place for a device");
    const auto own = exec.template array<std::uint32_t>(entries);
    exec.each("fill touching", regions, FillTouching{search, order.rank, order.in_order, first, own});
    const auto no_competitors = exec.template array<std::uint32_t>(regions + 1);
    exec.clear(no_competitors);
    return {field.segments, {first, own}, {no_competitors, {}}, field.blend, field.contact};
}

}  // namespace coppice::cuda
