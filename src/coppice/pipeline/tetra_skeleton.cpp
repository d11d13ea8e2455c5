#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/cut_field_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 1024;
// Most cells are about half as wide as they may be, and edges a little shorter than the cells are wide.
constexpr float kCellOverEdge = 2.8f;

std::vector<Segment> segments_of(const Skeleton& skeleton) {
    std::vector<Segment> segments;
    for (const NodeId n : nodes(skeleton)) {
        const float r = skeleton.radius(n);
        if (!skeleton.is_root(n)) {
            segments.push_back(skeleton.segment(n));
        } else if (skeleton.is_tip(n)) {
            segments.push_back({skeleton.position(n), skeleton.position(n), r, r});
        }
    }
    return segments;
}

/// Takes from the axes a radius, or a third of the segment, where a tree ends flat: there the surface passes
/// through the node. Segments are those of segments_of().
void shorten_flat_ends(std::vector<Segment>& axes, const Skeleton& skeleton, const ControlOptions& ends) {
    std::size_t i = 0;
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n) && !skeleton.is_tip(n)) continue;
        const Segment s = axes[i];
        Segment& axis = axes[i++];
        const float l = distance(s.a, s.b);
        if (skeleton.is_root(n) || l == 0) continue;
        const auto cut = [&](Vec3& end, float& radius_at_end, Vec3 other, float radius_at_other) {
            const float part = std::min(1.0f / 3, radius_at_end / l);
            end = lerp(end, other, part);
            radius_at_end += part * (radius_at_other - radius_at_end);
        };
        if (ends_flat(skeleton, skeleton.parent(n), ends)) cut(axis.a, axis.radius_a, s.b, s.radius_b);
        if (ends_flat(skeleton, n, ends)) cut(axis.b, axis.radius_b, s.a, s.radius_a);
    }
}

/// Whether a flat end is wider than all the rest reaches from it, so that axes tell nothing of the surface.
bool is_cut_away(const Skeleton& skeleton, const ControlOptions& ends) {
    Box3 box;
    float others = 0;
    for (const NodeId n : nodes(skeleton)) {
        box.extend(skeleton.position(n));
        if (!skeleton.is_root(n)) others = std::max(others, skeleton.radius(n));
    }
    for (const NodeId n : nodes(skeleton)) {
        if (ends_flat(skeleton, n, ends) && skeleton.radius(n) > box.diagonal() + others) return true;
    }
    return false;
}

std::vector<Box3> region_boxes(const TetraMesh& mesh, const Context& ctx) {
    std::vector<Box3> boxes(mesh.region_count());
    parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t r) {
        for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
            for (const std::uint32_t v : mesh.tetra[t]) boxes[r].extend(mesh.positions[v]);
        }
    });
    return boxes;
}

TetraSurface surface_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                   const MeshOptions& options, bool with_solid,
                                   std::optional<GlobalWeights>& weights, const Context& ctx,
                                   Stages& stages) {
    TetraSurface out;
    check_fields(options.tetra, "tetra");
    if (options.control.base == BaseShape::open) {
        throw InvalidInput("mesh: tetrahedra make closed surfaces only; choose base flat or round");
    }
    // Vertices of the hull stay where they are, so the surface should keep away from it; tetrahedra that are
    // cut reach far enough by themselves.
    const float shell = options.tetra.march.levels == 0 ? 0.3f : 0.2f;
    const LatticeOptions sizes{
        .cell = kCellOverEdge * options.tetra.edge * static_cast<float>(1 << options.tetra.march.levels),
        .inside = with_solid ? 0 : 1 - shell,
        .outside = 1 + shell};
    std::vector<Segment> axes = segments_of(prepared);
    Lattice lattice = stages.run("lattice", 0.2f, [&] { return Lattice(axes, sizes, ctx); });
    shorten_flat_ends(axes, prepared, options.control);
    ConvolutionField field = stages.run(
        "weights", 0.25f, [&] { return surface_field(prepared, options, constraints, weights, ctx); });
    for (bool again = true; again;) {
        const TetraMesh& mesh = lattice.mesh();
        const std::vector<Box3> boxes = stages.run("regions", 0.4f, [&] {
            auto found = region_boxes(mesh, ctx);
            field.set_regions(found, ctx);
            return found;
        });
        const CutField cut(FieldRef(field), prepared, options.control, boxes, ctx);
        MarchResult marched = stages.run("march", 0.95f, [&] {
            const InsideAxes inside{axes, lattice.passing()};
            return with_solid ? march_solid(mesh, FieldRef(cut), inside, options.tetra.march, ctx)
                              : march(mesh, FieldRef(cut), inside, options.tetra.march, ctx);
        });
        out.march = marched.report;
        out.mesh = std::move(marched.mesh);
        out.solid = std::move(marched.solid);
        again = !marched.open.empty();
        if (again) {
            ++out.grown;
            if (!lattice.grow(marched.open, ctx)) throw Error("mesh: the surface leaves the lattice");
        }
    }
    if (out.march.inside == 0 && is_cut_away(prepared, options.control)) {
        throw InvalidInput(
            "mesh: nothing is left of the surface, which is thinner than the tetrahedra everywhere; choose "
            "base round where a trunk is wider than long, a smaller edge, or method quads");
    }
    out.mesh.origin = out.solid.origin = prepared.origin();
    ctx.report(1);
    return out;
}

}  // namespace

TetraSurface mesh_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                const Context& ctx, Stages& stages) {
    return surface_by_tetrahedra(prepared, constraints, options, false, weights, ctx, stages);
}

TetraSurface solid_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                 const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                 const Context& ctx, Stages& stages) {
    return surface_by_tetrahedra(prepared, constraints, options, true, weights, ctx, stages);
}

}  // namespace coppice
