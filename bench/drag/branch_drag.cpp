#include "drag/branch_drag.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/rotation.h"

namespace coppice::bench {
namespace {

// Returns by node the number of segments that it carries, including its own.
std::vector<std::uint32_t> branch_sizes(const Skeleton& s) {
    std::vector<std::uint32_t> size(s.size(), 1);
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (const NodeId p = s.parent(NodeId(i))) size[p.index()] += size[i];
    }
    return size;
}

bool is_lateral(const Skeleton& s, NodeId n) { return !s.is_root(n) && s.leader(s.parent(n)) != n; }

// Rotates a point. The displacement is added to the position, so that a zero rotation returns the identical
// bits.
Vec3 turned_about(Vec3d pivot, const Rotation& turn, Vec3 p) {
    const Vec3d arm = Vec3d(p) - pivot;
    return Vec3(Vec3d(p) + (turn(arm) - arm));
}

}  // namespace

NodeId branch_of_about(const Skeleton& s, std::uint32_t segments) {
    const std::vector<std::uint32_t> size = branch_sizes(s);
    const double wanted = std::log(std::max(1u, segments));
    const auto nearest = [&](const auto& counts) {
        NodeId best;
        double least = std::numeric_limits<double>::infinity();
        for (const NodeId n : nodes(s)) {
            const double off = std::fabs(std::log(size[n.index()]) - wanted);
            if (!counts(n) || !(off < least)) continue;
            best = n;
            least = off;
        }
        return best;
    };
    const NodeId lateral = nearest([&](NodeId n) { return is_lateral(s, n); });
    return lateral ? lateral : nearest([&](NodeId n) { return !s.is_root(n); });
}

BranchDrag::BranchDrag(const QuadBuild& build, NodeId top, Vec3d axis)
    : build_(&build), top_(top), axis_(normalized(axis)) {
    const Skeleton& s = build.skeleton;
    COPPICE_ASSERT(top && top.index() < s.size() && !s.is_root(top));
    pivot_ = Vec3d(s.position(s.parent(top)));
    std::vector<std::uint8_t> turns(s.size());
    for (const NodeId n : coppice::nodes(s)) {
        const NodeId p = s.parent(n);
        if (n != top && (!p || turns[p.index()] == 0)) continue;
        turns[n.index()] = 1;
        nodes_.push_back(n.index());
    }
    find_shares(turns);
}

void BranchDrag::find_shares(const std::vector<std::uint8_t>& turns) {
    const ControlMesh& control = build_->cage;
    const auto region_turns = [&](std::uint32_t r) { return turns[control.region_node[r].index()] != 0; };
    for (std::uint32_t r = 0; r < control.region_node.size(); ++r) {
        if (region_turns(r)) tube_nodes_.push_back(r);
    }
    std::vector<std::uint32_t> all(control.cage.positions.size()), turning(all.size());
    for (std::size_t f = 0; f < control.region.size(); ++f) {
        for (const std::uint32_t v : control.cage.quads[f]) {
            ++all[v];
            turning[v] += region_turns(control.region[f]) ? 1 : 0;
        }
    }
    for (std::uint32_t v = 0; v < all.size(); ++v) {
        if (turning[v] == 0) continue;
        vertices_.push_back(v);
        shares_.push_back(static_cast<float>(turning[v]) / static_cast<float>(all[v]));
    }
    for (std::uint32_t k = 0; k < control.clip.size(); ++k) {
        if (region_turns(control.region[control.clip[k].first_quad])) clips_.push_back(k);
    }
}

DragPose BranchDrag::rest() const {
    const ControlMesh& control = build_->cage;
    const auto copy = [](std::span<const Vec3> v) { return std::vector<Vec3>(v.begin(), v.end()); };
    return {.nodes = copy(build_->skeleton.positions()),
            .tube_nodes = copy(build_->tubes.positions()),
            .cage = control.cage.positions,
            .anchors = control.anchors,
            .clips = control.clip};
}

void BranchDrag::turn(double angle, DragPose& pose) const {
    const ControlMesh& control = build_->cage;
    const Rotation whole = rotation_about(axis_, angle);
    pose.angle = angle;
    for (const std::uint32_t n : nodes_)
        pose.nodes[n] = turned_about(pivot_, whole, build_->skeleton.position(NodeId(n)));
    for (const std::uint32_t n : tube_nodes_)
        pose.tube_nodes[n] = turned_about(pivot_, whole, build_->tubes.position(NodeId(n)));
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        const std::uint32_t v = vertices_[i];
        const Rotation turn =
            shares_[i] == 1 ? whole : rotation_about(axis_, angle * static_cast<double>(shares_[i]));
        pose.cage[v] = turned_about(pivot_, turn, control.cage.positions[v]);
        pose.anchors[v] = turned_about(pivot_, turn, control.anchors[v]);
    }
    for (const std::uint32_t k : clips_) {
        const ClipPlane& clip = control.clip[k];
        const Vec3d normal(clip.normal), way = whole(normal) - normal;
        pose.clips[k].normal = Vec3(normal + way);
        pose.clips[k].offset = static_cast<float>(static_cast<double>(clip.offset) + dot(way, pivot_));
    }
}

}  // namespace coppice::bench
