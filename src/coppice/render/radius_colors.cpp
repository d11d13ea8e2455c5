#include "coppice/render/radius_colors.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/render/colors.h"

namespace coppice {
namespace {

/// Returns the colour of a radius; that of the middle if all radii are equal.
Rgb to_color(float radius, float min, float max) {
    const float range = std::log(max / min);
    const float t = range > 0 ? 2 * std::log(radius / min) / range - 1 : 0.0f;
    return to_srgb(deviation_color(std::clamp(t, -1.0f, 1.0f)));
}

}  // namespace

RadiusColors radius_colors(const Skeleton& skeleton, const PolygonMesh* mesh, const Context& ctx) {
    RadiusColors out;
    out.min = out.max = skeleton.radius(NodeId(0));
    for (const NodeId n : nodes(skeleton)) {
        out.min = std::min(out.min, skeleton.radius(n));
        out.max = std::max(out.max, skeleton.radius(n));
    }
    for (const NodeId n : nodes(skeleton))
        out.nodes.push_back(to_color(skeleton.radius(n), out.min, out.max));
    if (mesh == nullptr) return out;
    const CapsuleTree capsules(skeleton, mesh->origin, ctx);
    out.vertices.assign(mesh->positions.size(), to_srgb(deviation_color(NAN)));
    for_each_nearest(
        capsules, ctx, out.vertices.size(), [&](std::size_t v) { return Vec3d(mesh->positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest found) {
            if (found.capsule == kNoIndex) return;
            const double radius =
                capsules.cone(found.capsule).closest_point(Vec3d(mesh->positions[v])).radius;
            out.vertices[v] = to_color(static_cast<float>(radius), out.min, out.max);
        });
    return out;
}

}  // namespace coppice
