#include "coppice/pipeline/repair/tube_rows_internal.h"

#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"

namespace coppice::pipeline_internal {

TubeRows::TubeRows(const ControlMesh& cage, const Skeleton& tubes, int levels,
                   std::span<const std::array<float, 2>> sides)
    : cage_(&cage),
      tubes_(&tubes),
      levels_(levels),
      side_(sides),
      first_side_(tubes.size(), kNoIndex),
      ending_at_(compress_rows<NodeId>(tubes.size(),
                                       [&](const auto& put) {
                                           for (const NodeJoin& join : cage.joins)
                                               put(join.node.index(), join.end);
                                       })),
      end_(tubes.size()),
      has_fork_(tubes.size(), 0) {
    for (const NodeId n : nodes(tubes)) end_[n.index()] = n;
    for (const NodeJoin& join : cage.joins) end_[join.end.index()] = join.node;
    for (const NodeId n : nodes(tubes))
        has_fork_[n.index()] = degree(tubes, n) > 2 || !ending_at_[n.index()].empty() ? 1 : 0;
    for (std::uint32_t f = static_cast<std::uint32_t>(cage.region.size()); f-- > 0;) {
        if (cage.part[f] == TubeFace::side) first_side_[cage.region[f]] = f;
        if (cage.part[f] == TubeFace::fork) has_fork_[cage.region[f]] = 1;
    }
    for (std::uint32_t f = 0; f < cage.region.size() && sides_ == 0; ++f) {
        if (cage.part[f] != TubeFace::side) continue;
        while (f + sides_ < cage.region.size() && cage.region[f + sides_] == cage.region[f] &&
               cage.part[f + sides_] == TubeFace::side) {
            ++sides_;
        }
    }
}

std::uint32_t TubeRows::tube_count(NodeId n) const {
    std::uint32_t count = 0;
    for_each_tube_at(n, [&](NodeId) { ++count; });
    return count;
}

TubeRow TubeRows::of_quad(std::uint32_t quad) const {
    const std::uint32_t f = quad >> (2 * levels_);
    const NodeId tube = get_tube(f);
    switch (cage_->part[f]) {
        case TubeFace::start:
            return first(tube);
        case TubeFace::end:
            return last(tube);
        case TubeFace::fork:
            return at(tube, NodeId(cage_->region[f]));
        case TubeFace::side:
            break;
    }
    const std::uint32_t within = quad & ((1u << (2 * levels_)) - 1);
    return first(tube) + (within >> levels_);
}

TubeRow TubeRows::near(NodeId tube, Vec3 p) const {
    if (tubes_->is_root(tube)) return last(tube);
    const Vec3 a = tubes_->position(tubes_->parent(tube)), axis = tubes_->position(tube) - a;
    float t = closest_parameter(p, a, axis, 1.0f);
    if (!side_.empty()) {
        const auto [from, to] = side_[tube.index()];
        t = to > from ? std::clamp((t - from) / (to - from), 0.0f, 1.0f) : 0;
    }
    const auto row = static_cast<std::uint32_t>(t * static_cast<float>(per_tube()));
    return first(tube) + std::min(row, per_tube() - 1);
}

TubeRow TubeRows::next(TubeRow s, bool towards_tip) const {
    const NodeId here = tube(s);
    if (tubes_->is_root(here)) return kNoIndex;  // a ball, of which only the last row has quads
    if (towards_tip && row(s) + 1 < per_tube()) return s + 1;
    if (!towards_tip && row(s) > 0) return s - 1;
    const NodeId node = towards_tip ? end_node(here) : tubes_->parent(here);
    if (is_fork(node) || tube_count(node) != 2) return kNoIndex;
    TubeRow found = kNoIndex;
    for_each_tube_at(node, [&](NodeId t) {
        if (t != here) found = at(t, node);
    });
    return found;
}

Loop TubeRows::ring(TubeRow s, std::span<const Quad> quads) const {
    Loop out;
    const std::uint32_t n = per_tube(), f = first_side_[tube(s).index()];
    for (std::uint32_t side = 0; side < sides_; ++side) {
        const std::uint32_t begin = ((f + side) << (2 * levels_)) + row(s) * n;
        for (std::uint32_t i = 0; i < n; ++i) out.push_back(quads[begin + i][0]);
    }
    return out;
}

}  // namespace coppice::pipeline_internal
