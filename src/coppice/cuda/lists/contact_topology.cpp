#include "coppice/cuda/lists/contact_topology.h"

#include <numeric>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/cuda/field/upload_field_internal.h"

namespace coppice::cuda {
namespace {

// Returns segments sorted by axis, ascending within each; without blend only ascending.
Buffer<std::uint32_t> ordered_segments(const ConvolutionField& field) {
    const std::size_t count = field.axes().size();
    if (field.blend() > 1) return group_by(field.axes(), count).items;
    Buffer<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

std::vector<SegmentLink> segment_links(const Skeleton& skeleton, std::span<const NodeId> tube,
                                       std::span<const std::uint32_t> in_order) {
    std::vector<SegmentLink> links(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        SegmentLink& link = links[n.index()];
        const NodeId p = skeleton.is_root(n) ? n : skeleton.parent(n);
        link.start = p.index();
        link.thick = skeleton.leader(p) == n ? p.index() : n.index();
        // A root is a segment of its own only if the tree has no other node.
        if (!skeleton.is_root(n) || skeleton.is_tip(n)) link.competitor_of = tube[n.index()];
    }
    for (std::uint32_t rank = 0; rank < in_order.size(); ++rank) links[in_order[rank]].rank = rank;
    return links;
}

std::vector<TubeLink> tube_links(const Skeleton& tubes, std::span<const NodeId> region_node) {
    const std::vector<std::uint32_t> end = subtree_ends(tubes.parents());
    std::vector<TubeLink> links(tubes.size());
    std::vector<std::uint32_t> size(tubes.size(), 1);
    for (std::uint32_t t = tubes.size(); t-- > 0;) {
        const NodeId n(t), p = tubes.parent(n);
        if (p) size[p.index()] += size[t];
        COPPICE_ASSERT(end[t] - t == size[t]);  // depth-first order
        const bool follows = tubes.is_root(n) && !tubes.is_tip(n);
        links[t] = {p, end[t], follows ? tubes.leader(n).index() : t, region_node[t].index()};
    }
    return links;
}

std::vector<std::uint32_t> indices(std::span<const NodeId> ids) {
    std::vector<std::uint32_t> out;
    out.reserve(ids.size());
    for (const NodeId id : ids) out.push_back(id.index());
    return out;
}

// Appends rows with items offset by `base`.
void append(const CompressedRows<std::uint32_t>& rows, std::uint32_t base,
            CompressedRows<std::uint32_t>& to) {
    const auto items = static_cast<std::uint32_t>(to.items.size());
    for (std::size_t r = 0; r < rows.size(); ++r) to.first.push_back(items + rows.first[r + 1]);
    for (const std::uint32_t item : rows.items) to.items.push_back(base + item);
}

NodeId shifted(NodeId id, std::uint32_t by) { return id ? NodeId(id.index() + by) : id; }

// Appends one surface after others that have `quads` quads in total.
void append(const ContactTopology& one, std::uint32_t quads, ContactTopology& to) {
    const auto segments = static_cast<std::uint32_t>(to.segments.size());
    const auto tubes = static_cast<std::uint32_t>(to.tubes.size());
    for (const SegmentLink& s : one.segments)
        to.segments.push_back(
            {s.start + segments, s.thick + segments, shifted(s.competitor_of, tubes), s.rank + segments});
    for (const std::uint32_t s : one.in_order) to.in_order.push_back(s + segments);
    for (const TubeLink& t : one.tubes)
        to.tubes.push_back({shifted(t.parent, tubes), t.end + tubes, t.seed + tubes, t.source + segments});
    append(one.contents, segments, to.contents);
    append(one.quads, quads, to.quads);
    to.first_segment.push_back(static_cast<std::uint32_t>(to.segments.size()));
}

template <class T, class Values>
void append(const Values& values, std::vector<T>& to) {
    to.insert(to.end(), values.begin(), values.end());
}

}  // namespace

ContactPlaces::ContactPlaces(std::span<const ContactInput> inputs) : reach(inputs.front().field.reach()) {
    for (const ContactInput& input : inputs) {
        const auto first_vertex = static_cast<std::uint32_t>(cage.size());
        append(device_segments(input.field, static_cast<std::uint32_t>(segments.size())), segments);
        for (Quad quad : input.control.cage.quads) {
            for (std::uint32_t& v : quad) v += first_vertex;
            quads.push_back(quad);
        }
        append(input.skeleton.positions(), nodes);
        append(input.skeleton.radii(), radii);
        append(input.tubes.tree.positions(), tube_nodes);
        append(input.tubes.tree.radii(), tube_radii);
        append(input.control.cage.positions, cage);
        append(input.control.anchors, anchors);
    }
}

ContactTopology contact_topology(std::span<const ContactInput> inputs) {
    if (inputs.size() == 1) return contact_topology(inputs.front());
    ContactTopology out;
    out.first_segment = {0};
    std::uint32_t quads = 0;
    for (const ContactInput& input : inputs) {
        append(contact_topology(input), quads, out);
        quads += static_cast<std::uint32_t>(input.control.region.size());
    }
    return out;
}

ContactTopology contact_topology(const ContactInput& input) {
    const Skeleton& tubes = input.tubes.tree;
    COPPICE_ASSERT(input.control.region_node.size() == tubes.size());
    COPPICE_ASSERT(input.tubes.tube.size() == input.skeleton.size());
    COPPICE_ASSERT(input.field.contact() > 0);  // otherwise tubes have no effect
    COPPICE_ASSERT(input.field.axes().size() == input.skeleton.size());
    static_assert(NodeId::none().index() == kNoIndex);
    ContactTopology out;
    out.in_order = ordered_segments(input.field);
    out.segments = segment_links(input.skeleton, input.tubes.tube, out.in_order);
    out.tubes = tube_links(tubes, input.control.region_node);
    out.contents = group_by(indices(input.tubes.tube), tubes.size());
    out.quads = group_by(input.control.region, tubes.size());
    return out;
}

}  // namespace coppice::cuda
