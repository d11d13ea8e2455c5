#include "coppice/subdivision/relax.h"

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"

namespace coppice {

TangentialRelaxation::TangentialRelaxation(std::span<const Quad> quads, std::uint32_t vertex_count)
    : quads_(quads) {
    fan_first_.assign(std::size_t{vertex_count} + 1, 0u);
    for (const Quad& q : quads) {
        for (const std::uint32_t v : q) ++fan_first_[v];
    }
    exclusive_scan(std::span(fan_first_));
    fan_.resize(4 * quads.size());
    std::uint32_t half = 0;
    for (const Quad& q : quads) {
        for (const std::uint32_t v : q) fan_[fan_first_[v]++] = half++;
    }
    for (std::size_t v = vertex_count; v > 0; --v) fan_first_[v] = fan_first_[v - 1];
    fan_first_[0] = 0;
}

Vec3 TangentialRelaxation::relaxed(std::uint32_t vertex, std::span<const Vec3> positions,
                                   float weight) const {
    const Vec3 p = positions[vertex];
    Vec3 neighbours;
    Vec3 normal;
    // Around an inner vertex every neighbour follows once and precedes once; at a boundary the two sums
    // differ.
    std::uint64_t following = 0;
    std::uint64_t preceding = 0;
    for (std::uint32_t k = fan_first_[vertex]; k < fan_first_[vertex + 1]; ++k) {
        const Quad& q = quads_[fan_[k] >> 2];
        const std::uint32_t after = q[(fan_[k] + 1) & 3];
        const std::uint32_t before = q[(fan_[k] + 3) & 3];
        neighbours += positions[after] - p;
        normal += cross(positions[after] - p, positions[before] - p);
        following += after;
        preceding += before;
    }
    const std::uint32_t valence = fan_first_[vertex + 1] - fan_first_[vertex];
    const float normal_squared = length_squared(normal);
    if (valence == 0 || following != preceding || !(normal_squared > 0)) return p;
    const Vec3 move = neighbours / static_cast<float>(valence);
    return p + weight * (move - normal * (dot(move, normal) / normal_squared));
}

Buffer<Vec3> TangentialRelaxation::step(std::span<const Vec3> positions, float weight,
                                        const Context& ctx) const {
    COPPICE_ASSERT(positions.size() + 1 == fan_first_.size());
    Buffer<Vec3> out(positions.size());
    parallel_for(ctx, positions.size(), 8192,
                 [&](std::size_t v) { out[v] = relaxed(static_cast<std::uint32_t>(v), positions, weight); });
    return out;
}

}  // namespace coppice
