#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/fit/local_radii_internal.h"
#include "coppice/pipeline/fit/nearest_segment_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kLocalRadiiGrain = 2048;

void limit_radii(LocalRadii& local, const PolygonMesh& mesh, const CompressedRows<std::uint32_t>& faces_of,
                 const Context& ctx) {
    constexpr int kFaces = 4;
    for (int pass = 0; pass < kFaces; ++pass) {
        std::vector<float> limited(local.radius.size());
        parallel_for(ctx, limited.size(), kLocalRadiiGrain, [&](std::size_t v) {
            limited[v] = local.radius[v];
            for (const std::uint32_t f : faces_of[v]) {
                for (const std::uint32_t w : mesh.face(f)) {
                    if (local.capsule[w] == kNoIndex) continue;
                    limited[v] = std::min(limited[v],
                                          local.radius[w] + distance(mesh.positions[v], mesh.positions[w]));
                }
            }
        });
        local.radius = std::move(limited);
    }
}

}  // namespace

LocalRadii find_local_radii(const PolygonMesh& mesh, const CompressedRows<std::uint32_t>& faces_of,
                            const Skeleton& skeleton, const CapsuleTree& capsules, const Context& ctx) {
    const NearestSegment nearest(skeleton, capsules);
    LocalRadii out;
    out.capsule.resize(mesh.positions.size());
    out.radius.assign(mesh.positions.size(), 0);
    parallel_for_ranges(ctx, out.capsule.size(), kLocalRadiiGrain, [&](IndexRange range) {
        std::uint32_t hint = kNoIndex;
        for (std::size_t v = range.begin; v < range.end; ++v) {
            const Vec3d p(mesh.positions[v]);
            out.capsule[v] = hint = nearest(p, hint);
            if (hint == kNoIndex) continue;
            out.radius[v] = static_cast<float>(capsules.cone(hint).closest_point(p).radius);
        }
    });
    limit_radii(out, mesh, faces_of, ctx);
    return out;
}

}  // namespace coppice::pipeline_internal
