#include <algorithm>
#include <utility>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/deform/faults_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kFaultsGrain = 8192;
constexpr int kPasses = 12;

// Returns whether all corners are convex by a margin, so that rounding cannot make the face folded.
bool is_plainly_convex(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    constexpr float kMargin = 1e-3f;
    const Vec3 ab = b - a, bc = c - b, cd = d - c, da = a - d;
    const Vec3 normal = cross(c - a, d - b);
    const float size = length_squared(normal);
    const float limit = kMargin * size;
    const float at_a = dot(cross(da, ab), normal), at_b = dot(cross(ab, bc), normal);
    const float at_c = dot(cross(bc, cd), normal), at_d = dot(cross(cd, da), normal);
    return (at_a > limit) & (at_b > limit) & (at_c > limit) & (at_d > limit);
}

bool is_folded(const Quad& q, std::span<const Vec3> x) {
    return !is_plainly_convex(x[q[0]], x[q[1]], x[q[2]], x[q[3]]) && !(scaled_jacobian(q, x) > 0);
}

// Returns the mean of the corners before and after a vertex in its faces.
Vec3 mean_adjacent(std::uint32_t v, std::span<const Quad> quads, std::span<const std::uint32_t> faces,
                   std::span<const Vec3> x) {
    Vec3 sum;
    for (const std::uint32_t f : faces) {
        const Quad& q = quads[f];
        const auto at = static_cast<std::size_t>(std::find(q.begin(), q.end(), v) - q.begin());
        sum += x[q[(at + 1) % 4]] + x[q[(at + 3) % 4]];
    }
    return sum / static_cast<float>(2 * faces.size());
}

}  // namespace

std::vector<std::uint32_t> folded_faces(std::span<const Quad> quads, std::span<const Vec3> positions,
                                        const Context& ctx) {
    return parallel_reduce(
        ctx, quads.size(), kFaultsGrain, std::vector<std::uint32_t>{},
        [&](IndexRange range) {
            std::vector<std::uint32_t> found;
            for (std::size_t f = range.begin; f < range.end; ++f) {
                if (is_folded(quads[f], positions)) found.push_back(static_cast<std::uint32_t>(f));
            }
            return found;
        },
        [](std::vector<std::uint32_t> all, const std::vector<std::uint32_t>& more) {
            all.insert(all.end(), more.begin(), more.end());
            return all;
        });
}

std::vector<std::uint32_t> smooth_folds(std::span<const Quad> quads,
                                        const CompressedRows<std::uint32_t>& faces_of,
                                        std::vector<std::uint32_t> folded, std::span<Vec3> positions) {
    std::vector<std::pair<std::uint32_t, Vec3>> before;  // initial position of each moved vertex
    std::vector<std::uint32_t> now = folded;
    std::vector<std::uint32_t> touched = folded;  // faces
    for (int pass = 0; pass < kPasses && !now.empty(); ++pass) {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t f : now) {
            for (const std::uint32_t v : quads[f]) {
                corners.push_back(v);
                if (pass < 2) continue;
                for (const std::uint32_t g : faces_of[v])
                    corners.insert(corners.end(), quads[g].begin(), quads[g].end());
            }
        }
        sort_unique(corners);
        std::vector<Vec3> places;
        for (const std::uint32_t v : corners)
            places.push_back(lerp(positions[v], mean_adjacent(v, quads, faces_of[v], positions), 0.5f));
        for (std::size_t i = 0; i < corners.size(); ++i) {
            before.emplace_back(corners[i], positions[corners[i]]);
            positions[corners[i]] = places[i];
            const auto faces = faces_of[corners[i]];
            touched.insert(touched.end(), faces.begin(), faces.end());
        }
        sort_unique(touched);
        now.clear();
        std::ranges::copy_if(touched, std::back_inserter(now),
                             [&](std::uint32_t f) { return is_folded(quads[f], positions); });
    }
    if (now.size() < folded.size()) return now;
    for (auto at = before.rbegin(); at != before.rend(); ++at) positions[at->first] = at->second;
    return folded;
}

}  // namespace coppice::pipeline_internal
