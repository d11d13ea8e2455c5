#include "coppice/ramification/tube_tree_internal.h"

#include <algorithm>

namespace coppice::ramification_internal {

NodeId TubeTree::append(const Path& path, Tube tube) {
    tube.position = Vec3(path.position(tube.to));
    tube.radius = static_cast<float>(path.radius(tube.to));
    tubes_.push_back(tube);
    return NodeId(static_cast<std::uint32_t>(tubes_.size()) - 1);
}

NodeId TubeTree::add_root(const Branches& branches, std::uint32_t branch, double at) {
    return append(branches.path(branch), {.branch = branch, .from = at, .to = at});
}

NodeId TubeTree::add(const Branches& branches, std::uint32_t branch, NodeId from, double at, Sides sides) {
    constexpr double kMin = 1e-3;  // [radii] minimum length of a tube
    const Path path = branches.path(branch);
    const Tube& before = tubes_[from.index()];
    const double start = before.branch == branch ? before.to : 0;
    at = std::max(at, start + kMin * path.radius(start));
    return append(path, {.parent = from, .branch = branch, .from = start, .to = at, .sides = sides});
}

std::vector<std::array<float, 2>> TubeTree::sides() const {
    std::vector<std::array<float, 2>> out;
    for (const Tube& t : tubes_) {
        const double length = std::max(t.to - t.from, 1e-30);
        const auto parameter = [&](double at) {
            return static_cast<float>(std::clamp((at - t.from) / length, 0.0, 1.0));
        };
        out.push_back({parameter(t.sides.from), parameter(t.sides.to)});
    }
    return out;
}

Skeleton TubeTree::skeleton(Vec3d origin) const {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (const Tube& t : tubes_) {
        parent.push_back(t.parent);
        position.push_back(t.position);
        radius.push_back(t.radius);
    }
    return {std::move(parent), std::move(position), std::move(radius), origin};
}

std::vector<NodeId> TubeTree::source(const Branches& branches) const {
    std::vector<NodeId> out;
    out.reserve(tubes_.size());
    for (const Tube& t : tubes_) out.push_back(branches.node_at(t.branch, (t.from + t.to) / 2));
    return out;
}

CompressedRows<NodeId> TubeTree::wrapping(const Branches& branches, std::uint32_t nodes) const {
    return compress_rows<NodeId>(nodes, [&](const auto& put) {
        for (std::uint32_t i = 0; i < tubes_.size(); ++i) {
            const Tube& t = tubes_[i];
            if (!t.parent) continue;
            const Path path = branches.path(t.branch);
            std::uint32_t s = path.segment_at(t.from);
            do {
                put(branches.find_node(t.branch, s).index(), NodeId(i));
            } while (++s < path.segment_count() && path.arc(s) < t.to);
        }
    });
}

}  // namespace coppice::ramification_internal
