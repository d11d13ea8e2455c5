#include <algorithm>

#include "coppice/field/convolution_field.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/knots/knot_patch_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/remesh/quadrangulate.h"
#include "coppice/remesh/smooth_patch.h"

namespace coppice::pipeline_internal {
namespace {

constexpr int kSmoothingPasses = 6;
constexpr float kBoxMargin = 0.3f;  // [radii] that vertices may move out of their region's box

std::vector<EdgeMiddle> ring_middles(std::span<const Seam> seams) {
    std::vector<EdgeMiddle> out;
    std::uint32_t first = 0;
    for (const Seam& seam : seams) {
        const auto n = static_cast<std::uint32_t>(seam.ring.size());
        for (std::uint32_t k = 0; k < n; k += 2)
            out.push_back({first + k, first + (k + 2) % n, first + k + 1});
        first += n;
    }
    return out;
}

// The vertices that may move, each in the region of its nearest capsule.
std::vector<PatchVertex> moving_vertices(const KnotSurface& surface, const KnotQuads& made,
                                         std::span<const Care> care, const Context& ctx) {
    std::vector<std::uint8_t> is_used(made.positions.size(), 0);
    for (const Quad& q : made.quads) {
        for (const std::uint32_t v : q) is_used[v] = 1;
    }
    std::vector<PatchVertex> out;
    for (std::uint32_t v = surface.ring_vertices; v < is_used.size(); ++v) {
        if (is_used[v] != 0) out.push_back({v, 0, 0});
    }
    const auto point = [&](std::size_t i) { return Vec3d(made.positions[out[i].vertex]); };
    for_each_nearest(surface.capsules, ctx, out.size(), point, [&](std::size_t i, CapsuleTree::Nearest near) {
        out[i].region = near.capsule;
        if (near.capsule == CapsuleTree::kNone) return;
        out[i].radius = static_cast<float>(surface.capsules.cone(near.capsule).foot(point(i)).radius);
    });
    std::erase_if(out, [&](const PatchVertex& m) {
        if (m.region == CapsuleTree::kNone) return true;
        const Slice s = surface.knot.slice[surface.capsules.node(m.region).index()];
        return care[std::min<std::size_t>(s, care.size() - 1)] != Care::none;
    });
    std::sort(out.begin(), out.end(), [](const PatchVertex& a, const PatchVertex& b) {
        return a.region != b.region ? a.region < b.region : a.vertex < b.vertex;
    });
    return out;
}

// One region per capsule: about its vertices, and a little beyond.
std::vector<Box3> region_boxes(const CapsuleTree& capsules, std::span<const PatchVertex> moving,
                               std::span<const Vec3> positions) {
    std::vector<Box3> boxes(capsules.size());
    for (const PatchVertex& m : moving) boxes[m.region].extend(positions[m.vertex]);
    for (std::uint32_t b = 0; b < boxes.size(); ++b) {
        const RoundCone& cone = capsules.cone(b);
        if (boxes[b].empty()) boxes[b].extend(Vec3(cone.a));
        boxes[b] =
            boxes[b].inflated(kBoxMargin * static_cast<float>(std::max(cone.radius_a, cone.radius_b())));
    }
    return boxes;
}

// Puts vertices of folded quads back where they were before smoothing, until none is folded that was not.
void put_back_folded(KnotQuads& made, std::span<const Vec3> before) {
    for (bool moved = true; moved;) {
        moved = false;
        for (const Quad& q : made.quads) {
            if (scaled_jacobian(q, made.positions) > 0) continue;
            for (const std::uint32_t v : q) {
                moved |= made.positions[v] != before[v];
                made.positions[v] = before[v];
            }
        }
    }
}

}  // namespace

KnotQuads knot_quads(const KnotSurface& surface, std::span<const Care> care, const MeshOptions& options,
                     const Context& ctx) {
    std::vector<std::uint8_t> alone(surface.triangles.size());
    for (std::size_t t = 0; t < alone.size(); ++t) {
        alone[t] = care[std::min<std::size_t>(surface.slice[t], care.size() - 1)] == Care::flat ? 1 : 0;
    }
    KnotQuads out;
    out.positions = surface.positions;
    QuadPatch patch =
        quadrangulate(surface.triangles, alone, ring_middles(surface.group.seams), out.positions);
    out.quads = std::move(patch.quads);
    out.triangle = std::move(patch.triangle);
    const std::vector<PatchVertex> moving = moving_vertices(surface, out, care, ctx);
    if (moving.empty()) return out;
    std::optional<GlobalWeights> weights;
    ConvolutionField field = surface_field(surface.knot.skeleton, options, PointSet{}, weights, ctx);
    field.set_regions(region_boxes(surface.capsules, moving, out.positions), ctx);
    const Buffer<Vec3> before = out.positions;
    smooth_patch(out.positions, out.quads, moving, FieldRef(field), kSmoothingPasses, ctx);
    put_back_folded(out, before);
    return out;
}

}  // namespace coppice::pipeline_internal
