#include "coppice/compose/child_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/compose/branch_frame_internal.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

using namespace compose_internal;

/// Extracts branches from one skeleton; `number` is reused between branches.
class Cutter {
  public:
    explicit Cutter(const Skeleton& skeleton) : skeleton_(skeleton), number_(skeleton.size()) {}

    ChildTree cut(NodeId first) {
        const NodeId node = skeleton_.parent(first);
        const Vec3d direction = branch_direction(skeleton_, first),
                    parent_direction = compute_parent_direction(skeleton_, node);
        const Frame frame = branch_frame(direction, parent_direction);
        const Vec3d origin(skeleton_.position(node));
        std::vector<NodeId> parents{NodeId::none()};
        std::vector<Vec3> positions{Vec3{}};
        std::vector<float> radii{skeleton_.radius(first)};
        nodes_.assign(1, first);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const NodeId n = nodes_[i];
            number_[n.index()] = static_cast<std::uint32_t>(i + 1);
            parents.push_back(n == first ? NodeId(0) : NodeId(number_[skeleton_.parent(n).index()]));
            positions.push_back(Vec3(frame.to_local(Vec3d(skeleton_.position(n)) - origin)));
            radii.push_back(skeleton_.radius(n));
            for (const NodeId c : skeleton_.children(n)) nodes_.push_back(c);
        }
        return {.skeleton = Skeleton(std::move(parents), std::move(positions), std::move(radii)),
                .parent_radius = skeleton_.radius(node),
                .inclination =
                    static_cast<float>(std::acos(std::clamp(dot(direction, parent_direction), -1.0, 1.0))),
                .leads = skeleton_.leader(node) == first,
                .source_node = first.index()};
    }

  private:
    const Skeleton& skeleton_;
    std::vector<std::uint32_t> number_;
    std::vector<NodeId> nodes_;
};

}  // namespace

ChildTreeMeasures measure(const ChildTree& tree) {
    const Skeleton& s = tree.skeleton;
    const SkeletonMeasures m = measure(s);
    ChildTreeMeasures out{.length = m.length, .volume = m.volume, .nodes = m.nodes, .tips = m.tips};
    for (const Vec3 p : s.positions()) out.extent = std::max(out.extent, length(Vec3d(p)));
    out.orders = BranchSizes(s).orders[0];
    out.radius = s.radius(NodeId(std::min(1u, s.size() - 1)));
    return out;
}

std::vector<ChildTree> child_trees(const Skeleton& skeleton, const ChildTreeOptions& options,
                                   const Context& ctx) {
    check_fields(options, "child trees");
    const BranchSizes sizes(skeleton);
    Cutter cutter(skeleton);
    std::vector<ChildTree> out;
    for (const NodeId n : nodes(skeleton)) {
        if (!begins_child_tree(skeleton, n) || sizes.length[n.index()] < double{options.min_length}) continue;
        if (!options.leaders && skeleton.leader(skeleton.parent(n)) == n) continue;
        ctx.throw_if_cancelled();
        out.push_back(cutter.cut(n));
    }
    return out;
}

bool begins_child_tree(const Skeleton& skeleton, NodeId node) {
    return !skeleton.is_root(node) && skeleton.children(skeleton.parent(node)).size() > 1;
}

std::vector<ChildTree> child_trees_at(const Skeleton& skeleton, const std::vector<NodeId>& first) {
    Cutter cutter(skeleton);
    std::vector<ChildTree> out;
    for (const NodeId n : first) {
        if (!n || n.index() >= skeleton.size() || !begins_child_tree(skeleton, n)) {
            throw InvalidInput(fmt::format(
                "node {} begins no branch: name children of nodes that have several children", n.index()));
        }
        out.push_back(cutter.cut(n));
    }
    return out;
}

void list_fields(ChildTreeOptions& o, FieldList& list) {
    list.add(Field{"leaders", "Include branches that continue their parent branch."}, o.leaders);
    list.add(Field{"min_length", "Minimum total length of the segments of a branch.", Unit::metre, 0, 1e6},
             o.min_length);
}

}  // namespace coppice
