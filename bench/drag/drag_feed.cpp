#include "drag/drag_feed.h"

#include <algorithm>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/id.h"

namespace coppice::bench {

DragFeed::DragFeed(const QuadBuild& build, const BranchDrag& drag, const DragPart& part, const Context& ctx)
    : build_(&build),
      drag_(&drag),
      part_(&part),
      control_(make_control(build, part)),
      field_(build.skeleton, build.field, ctx),
      segments_(build.skeleton, SegmentBuilder(build.field)),
      moved_nodes_(drag.nodes().size()),
      moved_tubes_(drag.tube_nodes().size()),
      moved_vertices_(drag.cage_vertices().size()) {
    for (const std::uint32_t v : part.vertex) drawn_.push_back(build.refined[v]);
    find_vertices();
    find_quads();
}

void DragFeed::find_vertices() {
    const std::vector<std::uint32_t>& all = part_->cage_vertex;
    for (const std::uint32_t v : drag_->cage_vertices()) {
        const auto at = std::ranges::lower_bound(all, v);
        COPPICE_ASSERT(at != all.end() && *at == v);  // rotating nodes are in the part
        vertices_.push_back(static_cast<std::uint32_t>(at - all.begin()));
    }
}

// Finds the drawn quads that are in a fan.
void DragFeed::find_quads() {
    std::vector<std::uint32_t> place(part_->quads.size(), kNoIndex);
    for (const std::uint32_t q : part_->fans.items) {
        if (place[q] == kNoIndex) {
            place[q] = static_cast<std::uint32_t>(quads_about_.size());
            quads_about_.push_back(part_->quads[q]);
        }
        fan_quads_.push_back(place[q]);
    }
}

DragJob DragFeed::job() const {
    return {.quads = {part_->patches.cage(),
                      part_->patches.levels(),
                      control_.cage.positions,
                      control_.anchors,
                      control_.region,
                      control_.clip,
                      build_->options.project,
                      {.passes = 0}},
            .contacts = {build_->skeleton, {build_->tubes, build_->tube}, field_, control_},
            .nodes = drag_->nodes(),
            .tube_nodes = drag_->tube_nodes(),
            .vertices = vertices_,
            .drawn = drawn_,
            .from = part_->from,
            .fan_first = part_->fans.first,
            .fan_quads = fan_quads_,
            .quads_about = quads_about_};
}

DragMoves DragFeed::moves(const DragPose& pose) {
    segments_.follow(drag_->nodes(), pose.nodes);
    for (std::size_t i = 0; i < moved_nodes_.size(); ++i) {
        const std::uint32_t n = drag_->nodes()[i];
        moved_nodes_[i] = {segments_.build(NodeId(n), pose.nodes), pose.nodes[n]};
    }
    for (std::size_t i = 0; i < moved_tubes_.size(); ++i)
        moved_tubes_[i] = pose.tube_nodes[drag_->tube_nodes()[i]];
    for (std::size_t i = 0; i < moved_vertices_.size(); ++i) {
        const std::uint32_t v = drag_->cage_vertices()[i];
        moved_vertices_[i] = {pose.cage[v], pose.anchors[v]};
    }
    clips_ = select_clip_planes(*part_, pose.clips);
    return {moved_nodes_, moved_tubes_, moved_vertices_, clips_};
}

}  // namespace coppice::bench
