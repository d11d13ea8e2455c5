#include "coppice/subdivision/relax_internal.h"

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/mesh/half_edges.h"

namespace coppice {

TangentialRelaxation::TangentialRelaxation(std::span<const Quad> quads, std::uint32_t vertex_count)
    : quads_(quads), fans_(group_by(all_corners(quads), vertex_count)) {}

Vec3 TangentialRelaxation::relaxed(std::uint32_t vertex, std::span<const Vec3> positions,
                                   float weight) const {
    const Vec3 p = positions[vertex];
    Vec3 neighbours;
    Vec3 normal;
    // Around an inner vertex every neighbour follows once and precedes once; at a boundary the two sums
    // differ.
    std::uint64_t following = 0;
    std::uint64_t preceding = 0;
    const auto fan = fans_[vertex];
    for (const std::uint32_t half : fan) {
        const Quad& q = quads_[half >> 2];
        const std::uint32_t after = q[(half + 1) & 3];
        const std::uint32_t before = q[(half + 3) & 3];
        neighbours += positions[after] - p;
        normal += cross(positions[after] - p, positions[before] - p);
        following += after;
        preceding += before;
    }
    const float normal_squared = length_squared(normal);
    if (fan.empty() || following != preceding || !(normal_squared > 0)) return p;
    const Vec3 move = neighbours / static_cast<float>(fan.size());
    return p + weight * (move - normal * (dot(move, normal) / normal_squared));
}

Buffer<Vec3> TangentialRelaxation::step(std::span<const Vec3> positions, float weight,
                                        const Context& ctx) const {
    COPPICE_ASSERT(positions.size() == fans_.size());
    Buffer<Vec3> out(positions.size());
    parallel_for(ctx, positions.size(), 8192,
                 [&](std::size_t v) { out[v] = relaxed(static_cast<std::uint32_t>(v), positions, weight); });
    return out;
}

}  // namespace coppice
