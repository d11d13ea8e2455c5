#include "coppice/pipeline/texture/flat_cuts_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/end_cuts_internal.h"
#include "coppice/pipeline/texture/texture_quality_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kFaceGrain = 4096;
constexpr float kMaxReach = 2;       // [radii] maximum distance of the rim from the centre of an end
constexpr float kMaxHeight = 0.01f;  // [radii] maximum distance of a vertex from the plane of an end

}  // namespace

std::vector<FlatCuts::End> FlatCuts::find_ends(const Skeleton& prepared, const ControlOptions& ends,
                                               Vec3d origin) {
    const Vec3 shift(prepared.origin() - origin);
    std::vector<End> out;
    for (const NodeId n : nodes(prepared)) {
        if (!ends_flat(prepared, n, ends)) continue;
        const NodeId inward = prepared.is_root(n) ? prepared.leader(n) : prepared.parent(n);
        const Vec3 axis = prepared.position(n) - prepared.position(inward);
        if (length(axis) == 0) continue;
        out.push_back({prepared.position(n) + shift, normalized(axis), prepared.radius(n)});
    }
    return out;
}

std::vector<Box3> FlatCuts::make_boxes(std::span<const End> ends) {
    std::vector<Box3> out;
    for (const End& end : ends) out.push_back(capsule_box(end.center, end.center, kMaxReach * end.radius));
    return out;
}

FlatCuts::FlatCuts(const Skeleton& prepared, const ControlOptions& ends, Vec3d origin, const Context& ctx)
    : ends_(find_ends(prepared, ends, origin)), tree_(make_boxes(ends_), ctx) {}

bool FlatCuts::closes(const End& end, const FaceView& mesh, std::uint32_t face) const {
    return std::ranges::all_of(mesh.face(face), [&](std::uint32_t v) {
        const Vec3 d = mesh.positions()[v] - end.center;
        return std::abs(dot(d, end.normal)) <= kMaxHeight * end.radius && length(d) <= kMaxReach * end.radius;
    });
}

std::vector<std::uint32_t> FlatCuts::find(const FaceView& mesh, const Context& ctx) const {
    std::vector<std::uint32_t> out(mesh.size(), kNoIndex);
    if (ends_.empty()) return out;
    parallel_for(ctx, mesh.size(), kFaceGrain, [&](std::size_t i) {
        const auto f = static_cast<std::uint32_t>(i);
        tree_.visit_overlapping(mesh.box(f), [&](std::uint32_t end) {
            if (closes(ends_[end], mesh, f)) out[i] = std::min(out[i], end);
        });
    });
    return out;
}

void FlatCuts::map(const FaceView& mesh, std::span<const std::uint32_t> end_of_face, Texture& texture) const {
    std::vector<float> reach(ends_.size(), 0);  // [m] of the rims
    for (std::uint32_t f = 0; f < mesh.size(); ++f) {
        const std::uint32_t end = end_of_face[f];
        if (end == kNoIndex) continue;
        for (const std::uint32_t v : mesh.face(f))
            reach[end] = std::max(reach[end], distance(mesh.positions()[v], ends_[end].center));
    }
    std::size_t first = 0;  // corner
    std::vector<Vec3> corners;
    for (std::uint32_t f = 0; f < mesh.size(); first += mesh.face(f++).size()) {
        if (end_of_face[f] == kNoIndex) continue;
        const End& end = ends_[end_of_face[f]];
        corners.clear();
        for (const std::uint32_t v : mesh.face(f)) corners.push_back(mesh.positions()[v]);
        const auto points = std::span(texture.points).subspan(first, corners.size());
        project_on_plane(corners, {end.center, end.normal, perpendicular(end.normal)},
                         1 / (2 * reach[end_of_face[f]]), points);
        for (std::size_t k = 0; k < points.size(); ++k) {
            points[k] = {points[k].u + 0.5f, points[k].v + 0.5f};
            if (!texture.blends.empty()) texture.blends[first + k] = {points[k], 0};
        }
    }
}

}  // namespace coppice::pipeline_internal
