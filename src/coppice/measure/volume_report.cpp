#include "coppice/measure/volume_report.h"

#include <algorithm>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/measure/union_volume.h"

namespace coppice {
namespace {

/// Joins segments that share a node.
std::vector<MissingLump> find_lumps(std::span<const double> missing, const Skeleton& skeleton,
                                    const CapsuleTree& capsules) {
    DisjointSets lump(skeleton.size());
    const auto meets = [&](std::uint32_t i) {
        const NodeId n = capsules.node(i);
        return skeleton.is_root(n) ? n : skeleton.parent(n);
    };
    // A node represents its child segments, after they are joined with its own segment if that misses a
    // volume too.
    std::vector<bool> concerned(skeleton.size(), false);
    for (std::uint32_t i = 0; i < capsules.size(); ++i) concerned[capsules.node(i).index()] = missing[i] > 0;
    std::vector<std::uint32_t> first(skeleton.size(), kNoIndex);
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        if (missing[i] <= 0) continue;
        const std::uint32_t n = capsules.node(i).index(), above = meets(i).index();
        if (concerned[above]) lump.join(n, above);
        if (first[above] == kNoIndex) first[above] = n;
        lump.join(n, first[above]);
    }
    std::vector<MissingLump> of_set(skeleton.size());
    std::vector<double> most(skeleton.size(), 0.0);
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        if (missing[i] <= 0) continue;
        const NodeId n = capsules.node(i);
        const std::uint32_t set = lump.find(n.index());
        MissingLump& l = of_set[set];
        l.volume += missing[i];
        ++l.segments;
        if (missing[i] <= most[set]) continue;
        most[set] = missing[i];
        l.node = n;
        l.place = Vec3d(skeleton.position(n)) + skeleton.origin();
    }
    std::erase_if(of_set, [](const MissingLump& l) { return l.segments == 0; });
    std::ranges::stable_sort(of_set, std::ranges::greater(), &MissingLump::volume);
    of_set.resize(std::min(of_set.size(), VolumeReport::kMaxLumps));
    return of_set;
}

}  // namespace

VolumeReport volume_report(const SurfaceTree& surface, double mesh_volume, const Skeleton& skeleton,
                           const ConeUnion& solid, std::span<const std::uint8_t> is_deep,
                           const Context& ctx) {
    const auto outside = [&](std::uint32_t capsule, Vec3d p, double radius) {
        return is_deep[capsule] == 0 && !surface.is_within(p, VolumeReport::kMissingMargin * radius) &&
               surface.signed_distance(p) > 0;
    };
    const UnionVolume cones = union_volume(solid, {}, outside, ctx);
    VolumeReport report{.mesh = mesh_volume, .cones = cones.total, .error = cones.error};
    for (const double v : cones.marked) report.missing += v;
    report.lumps = find_lumps(cones.marked, skeleton, solid.capsules());
    return report;
}

}  // namespace coppice
