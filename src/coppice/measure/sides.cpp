#include <algorithm>
#include <bit>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/measure/sides.h"

namespace coppice {
namespace {

constexpr std::size_t kSidesGrain = 1 << 13;

}  // namespace

Buffer<Side> sorted_sides(const PolygonMesh& mesh, const Context& ctx) {
    Buffer<Side> sides(mesh.corners.size());
    parallel_for(ctx, mesh.face_count(), kSidesGrain, [&](std::size_t f) {
        const auto id = static_cast<std::uint32_t>(f);
        const auto face = mesh.face(id);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::uint32_t a = face[k], b = face[k + 1 < face.size() ? k + 1 : 0];
            const std::uint32_t number = mesh.first[f] + static_cast<std::uint32_t>(k);
            sides[number] = {std::min(a, b), std::max(a, b), id, number};
        }
    });
    const int bits = std::bit_width(mesh.positions.size());
    radix_sort(ctx, sides, bits, [](const Side& s) { return s.high; });
    radix_sort(ctx, sides, bits, [](const Side& s) { return s.low; });
    return sides;
}

bool are_edge_of_two(const Buffer<Side>& sides, std::size_t i) {
    const auto same = [&](std::size_t a, std::size_t b) {
        return b < sides.size() && sides[a].low == sides[b].low && sides[a].high == sides[b].high;
    };
    return !(i > 0 && same(i - 1, i)) && same(i, i + 1) && !same(i, i + 2);
}

}  // namespace coppice
