#include "coppice/edit/animate/pose.h"

#include <cmath>

namespace coppice {

Pose rest_pose(const Skeleton& s) {
    return {{s.positions().begin(), s.positions().end()},
            {s.radii().begin(), s.radii().end()},
            std::vector<Rotation>(s.size())};
}

Skeleton posed(const Skeleton& s, const Pose& pose) {
    return {{s.parents().begin(), s.parents().end()},
            pose.positions,
            pose.radii,
            s.origin(),
            {s.stable_ids().begin(), s.stable_ids().end()}};
}

Pose on_the_way(const Skeleton& s, const Pose& from, const Pose& to, double part) {
    Pose out = from;
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        const Rotation end = signed_as(to.turns[i], from.turns[i]);
        const Rotation &a = from.turns[i], turn = unit({std::lerp(a.w, end.w, part), lerp(a.v, end.v, part)});
        out.turns[i] = turn;
        out.radii[i] = static_cast<float>(std::lerp(double{from.radii[i]}, double{to.radii[i]}, part));
        const NodeId parent = s.parent(n);
        if (!parent) {
            out.positions[i] = Vec3(lerp(Vec3d(from.positions[i]), Vec3d(to.positions[i]), part));
            continue;
        }
        const std::uint32_t p = parent.index();
        const auto own_way = [&](const Pose& pose) {
            return inverse(pose.turns[i])(Vec3d(pose.positions[i]) - Vec3d(pose.positions[p]));
        };
        out.positions[i] = Vec3(Vec3d(out.positions[p]) + turn(lerp(own_way(from), own_way(to), part)));
    }
    return out;
}

Pose freeze(const Skeleton& s, const Pose& wanted, const Pose& last,
            std::span<const std::uint8_t> is_frozen) {
    Pose out = wanted;
    std::vector<std::uint8_t> differs(s.size());  // whether a node differs from the requested pose
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        const Pose& from = is_frozen[i] != 0 ? last : wanted;
        const NodeId parent = s.parent(n);
        differs[i] = is_frozen[i] != 0 || (parent && differs[parent.index()] != 0) ? 1 : 0;
        if (differs[i] == 0) continue;
        if (is_frozen[i] != 0) out.radii[i] = last.radii[i];
        if (!parent) {
            out.positions[i] = from.positions[i];
            out.turns[i] = from.turns[i];
            continue;
        }
        const std::uint32_t p = parent.index();
        const Rotation turned = out.turns[p] * inverse(from.turns[p]);
        const Vec3d way = Vec3d(from.positions[i]) - Vec3d(from.positions[p]);
        out.positions[i] = Vec3(Vec3d(out.positions[p]) + turned(way));
        out.turns[i] = unit(turned * from.turns[i]);
    }
    return out;
}

void freeze_between(const Skeleton& s, NodeId a, NodeId b, std::span<std::uint8_t> is_frozen) {
    // Parents precede their children, so the later of two nodes is not an ancestor of the other.
    while (a != b) {
        NodeId& later = !b || (a && b < a) ? a : b;
        is_frozen[later.index()] = 1;
        later = s.parent(later);
    }
}

}  // namespace coppice
