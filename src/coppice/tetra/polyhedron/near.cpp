#include "coppice/tetra/polyhedron/near_internal.h"

#include <algorithm>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/cone_internal.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice::tetra_internal {
namespace {

constexpr std::size_t kNearGrain = 256;
constexpr std::size_t kPoll = 4096;  ///< cells between two checks for cancellation
constexpr std::uint64_t kMaxMeetings = std::uint64_t{1}
                                       << 29;  ///< maximum number of intersections of cells and cones

/// Returns the cells that contain the ends a of the cones; each search starts from the previous result.
std::vector<std::uint32_t> cells_about_ends(const Filling& filling, std::span<const RoundCone> cones,
                                            const Context& ctx) {
    std::vector<std::uint32_t> out(cones.size());
    std::uint32_t cell = filling.cells.some_cell();
    for (std::size_t i = 0; i < cones.size(); ++i) {
        if (i % kNearGrain == 0) ctx.throw_if_cancelled();
        out[i] = cell = filling.cells.locate(filling.place(cones[i].a), cell);
    }
    return out;
}

}  // namespace

bool parted(const RoundCone& cone, double times, const std::array<Vec3d, 4>& corners) {
    const auto parts = [&](Vec3d n) {
        const double l = length(n);
        if (!(l > 0)) return false;
        double least = dot(n, corners[0]);
        for (std::size_t i = 1; i < 4; ++i) least = std::min(least, dot(n, corners[i]));
        return least > support(cone, times, n, l);
    };
    const auto away = [&](Vec3d p) { return p - cone.point(nearest_ball(cone, times, p)); };
    if (parts(away(0.25 * (corners[0] + corners[1] + corners[2] + corners[3])))) return true;
    for (const auto& f : kTetraFaces) {
        // Face normals point outward, and the normal of a separating plane points from the cone to the
        // tetrahedron.
        const Vec3d a = corners[f[0]], b = corners[f[1]], c = corners[f[2]];
        if (parts(cross(c - a, b - a)) || parts(away((a + b + c) * (1.0 / 3)))) return true;
    }
    return std::ranges::any_of(corners, [&](Vec3d p) { return parts(away(p)); });
}

CompressedRows<std::uint32_t> cells_near(const Filling& filling, std::span<const RoundCone> cones,
                                         double times, const Context& ctx) {
    const std::vector<std::uint32_t> start = cells_about_ends(filling, cones, ctx);
    std::vector<std::vector<std::uint32_t>> found((cones.size() + kNearGrain - 1) / kNearGrain);
    CompressedRows<std::uint32_t> out;
    out.first.assign(cones.size() + 1, 0);
    parallel_for_ranges(ctx, cones.size(), kNearGrain, [&](IndexRange range) {
        std::vector<std::uint32_t>& items = found[range.begin / kNearGrain];
        NumberSet seen(filling.cells.cells().size());
        std::vector<std::uint32_t> looked_at;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const std::size_t begin = items.size();
            looked_at.assign(1, start[i]);
            seen.add(start[i]);
            items.push_back(start[i]);
            for (std::size_t k = begin; k < items.size(); ++k) {
                if ((k - begin) % kPoll == kPoll - 1) ctx.throw_if_cancelled();
                for (const std::uint32_t next : filling.cells.cells()[items[k]].next) {
                    if (next == kNoIndex || !seen.add(next)) continue;
                    looked_at.push_back(next);
                    if (!parted(cones[i], times, filling.corners(next))) items.push_back(next);
                }
            }
            for (const std::uint32_t cell : looked_at) seen.remove(cell);
            out.first[i] = static_cast<std::uint32_t>(items.size() - begin);
        }
    });
    std::uint64_t meetings = 0;
    for (const auto& items : found) meetings += items.size();
    if (meetings > kMaxMeetings) {
        throw InvalidInput(
            "polyhedron: too many segments are at one place; use tetra_base octree, or mesh a part of the "
            "skeleton");
    }
    out.items.reserve(exclusive_scan(std::span(out.first)));
    for (const auto& items : found) out.items.insert(out.items.end(), items.begin(), items.end());
    return out;
}

}  // namespace coppice::tetra_internal
