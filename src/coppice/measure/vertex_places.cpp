#include "coppice/measure/vertex_places.h"

#include "coppice/base/id.h"

namespace coppice {
namespace {

constexpr double kEndZone = 2;  // [radii]

/// Properties of a segment of the skeleton other than its geometry.
struct Ends {
    bool bare_a, bare_b;  ///< the end is a branch node, root or tip, near which the radius is not regular
};

std::vector<Ends> find_ends(const Skeleton& skeleton, const CapsuleTree& capsules) {
    std::vector<Ends> ends(capsules.size());
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
        const NodeId b = capsules.node(i), a = skeleton.parent(b);
        const bool branch_a = skeleton.children(a).size() > 1, branch_b = skeleton.children(b).size() > 1;
        ends[i] = {branch_a || skeleton.is_root(a), branch_b || skeleton.is_tip(b)};
    }
    return ends;
}

bool is_regular(const RoundCone& c, const Ends& ends, Vec3d p) {
    const double t = c.line_parameter(p), l = length(c.axis);
    if (!(t > 0 && t < 1)) return false;
    return !(ends.bare_a && t * l < kEndZone * c.radius_a) &&
           !(ends.bare_b && (1 - t) * l < kEndZone * c.radius_b());
}

}  // namespace

VertexPlaces vertex_places(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                           const Context& ctx) {
    const std::size_t n = mesh.positions.size();
    std::vector<char> used(n);
    for (const std::uint32_t v : mesh.corners) used[v] = 1;
    const std::vector<Ends> ends = find_ends(skeleton, capsules);
    VertexPlaces places{std::vector<CapsuleTree::Nearest>(n), std::vector<char>(n)};
    for_each_nearest(
        capsules, ctx, n, [&](std::size_t v) { return Vec3d(mesh.positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest found) {
            if (used[v] == 0 || found.capsule == kNoIndex) return;
            places.nearest[v] = found;
            const std::uint32_t c = found.capsule;
            places.is_regular[v] = is_regular(capsules.cone(c), ends[c], Vec3d(mesh.positions[v])) ? 1 : 0;
        });
    return places;
}

}  // namespace coppice
