#include "coppice/cuda/lists/contact_topology.h"

#include <numeric>

#include "coppice/base/error.h"

namespace coppice::cuda {
namespace {

// Segments axis by axis, ascending in each; without blend ascending.
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
        // A root is a segment of its own only where it is all there is.
        if (!skeleton.is_root(n) || skeleton.is_tip(n)) link.rival_of = tube[n.index()];
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

}  // namespace

ContactTopology contact_topology(const ContactInput& input) {
    const Skeleton& tubes = input.tubes.tree;
    COPPICE_ASSERT(input.control.region_node.size() == tubes.size());
    COPPICE_ASSERT(input.tubes.tube.size() == input.skeleton.size());
    COPPICE_ASSERT(input.field.contact() > 0);  // else tubes do not count
    COPPICE_ASSERT(input.field.axes().size() == input.skeleton.size());
    static_assert(NodeId::none().index() == kNoRow);
    ContactTopology out;
    out.in_order = ordered_segments(input.field);
    out.segments = segment_links(input.skeleton, input.tubes.tube, out.in_order);
    out.tubes = tube_links(tubes, input.control.region_node);
    out.contents = group_by(indices(input.tubes.tube), tubes.size());
    out.quads = group_by(input.control.region, tubes.size());
    return out;
}

}  // namespace coppice::cuda
