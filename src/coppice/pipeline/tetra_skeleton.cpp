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

std::vector<Box3> region_boxes(const TetraMesh& mesh, const Context& ctx) {
    std::vector<Box3> boxes(mesh.region_count());
    parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t r) {
        for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
            for (const std::uint32_t v : mesh.tetra[t]) boxes[r].extend(mesh.positions[v]);
        }
    });
    return boxes;
}

}  // namespace

TetraSurface mesh_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                const Context& ctx, Stages& stages) {
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
        .inside = 1 - shell,
        .outside = 1 + shell};
    Lattice lattice = stages.run("lattice", 0.2f, [&] { return Lattice(segments_of(prepared), sizes, ctx); });
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
        MarchResult marched =
            stages.run("march", 0.95f, [&] { return march(mesh, FieldRef(cut), options.tetra.march, ctx); });
        out.march = marched.report;
        out.mesh = std::move(marched.mesh);
        again = !marched.open.empty();
        if (again) {
            ++out.grown;
            if (!lattice.grow(marched.open, ctx)) throw Error("mesh: the surface leaves the lattice");
        }
    }
    if (out.mesh.triangles.empty()) {
        throw InvalidInput(
            "mesh: nothing is left of the surface, which is thinner than the tetrahedra everywhere; choose "
            "base round where a trunk is wider than long, a smaller edge, or method quads");
    }
    out.mesh.origin = prepared.origin();
    ctx.report(1);
    return out;
}

}  // namespace coppice
