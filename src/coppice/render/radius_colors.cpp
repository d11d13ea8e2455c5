#include "coppice/render/radius_colors.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/render/colors.h"
#include "coppice/render/value_colors.h"

namespace coppice {

RadiusColors radius_colors(const Skeleton& skeleton, const PolygonMesh* mesh, const Context& ctx) {
    RadiusColors out;
    out.min = out.max = skeleton.radius(NodeId(0));
    for (const NodeId n : nodes(skeleton)) {
        out.min = std::min(out.min, skeleton.radius(n));
        out.max = std::max(out.max, skeleton.radius(n));
    }
    for (const NodeId n : nodes(skeleton))
        out.nodes.push_back(value_color(skeleton.radius(n), out.min, out.max, ValueScale::logarithmic));
    if (mesh == nullptr) return out;
    const CapsuleTree capsules(skeleton, mesh->origin, ctx);
    out.vertices.assign(mesh->positions.size(), to_srgb(deviation_color(NAN)));
    for_each_nearest(
        capsules, ctx, out.vertices.size(), [&](std::size_t v) { return Vec3d(mesh->positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest found) {
            if (found.capsule == kNoIndex) return;
            const double radius =
                capsules.cone(found.capsule).closest_point(Vec3d(mesh->positions[v])).radius;
            out.vertices[v] =
                value_color(static_cast<float>(radius), out.min, out.max, ValueScale::logarithmic);
        });
    return out;
}

}  // namespace coppice
