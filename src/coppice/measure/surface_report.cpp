#include "coppice/measure/surface_report.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"

namespace coppice {
namespace {

/// Runs the checks that require a SurfaceTree: the intersection test, the axes and the volume.
void check_tree(const PolygonMesh& mesh, const Skeleton* skeleton, const CapsuleTree* capsules,
                const CheckOptions& options, const Context& ctx, SurfaceReport& report) {
    const SurfaceTree surface(mesh, ctx);
    ctx.throw_if_cancelled();
    ctx.report(0.3f);
    if (options.intersections) {
        const auto limit = static_cast<std::uint32_t>(options.max_intersections);
        const FacePairs found = crossing_faces(surface, limit, ctx);
        report.intersections = classify(found, mesh, skeleton, capsules, ctx);
        report.crossing_places = crossing_places(found, mesh, skeleton, capsules,
                                                 static_cast<std::size_t>(options.max_places), ctx);
    }
    ctx.report(0.7f);
    if (capsules == nullptr) return;
    const ConeUnion solid(*skeleton, mesh.origin, options.base, options.tips, ctx);
    AxesFound axes = judge_axes(mesh, *skeleton, solid, options.tips, ctx);
    report.axes = std::move(axes.report);
    ctx.throw_if_cancelled();
    ctx.report(0.75f);
    if (report.watertight()) {
        const auto parts = static_cast<std::int64_t>(report.topology.components);
        if (const auto cones = count_union_handles(solid.capsules(), *skeleton, ctx))
            report.handles = {parts - report.topology.euler / 2, *cones};
    }
    report.volume = volume_report(surface, report.shape.signed_volume, *skeleton, solid, axes.is_deep,
                                  narrow_progress(ctx, 0.75f, 0.9f));
}

}  // namespace

SurfaceReport check_surface(const PolygonMesh& mesh, const Skeleton* skeleton, const CheckOptions& options,
                            const Context& ctx) {
    check_fields(options, "check");
    validate(mesh);
    SurfaceReport report;
    HalfEdges edges(mesh, ctx);
    report.topology = topology(edges, ctx);
    ctx.throw_if_cancelled();
    report.shape = shape(mesh, ctx);
    ctx.throw_if_cancelled();
    report.smoothness = smoothness(mesh, edges, skeleton, ctx);
    if (skeleton == nullptr) edges = {};  // memory for the next checks
    ctx.throw_if_cancelled();
    ctx.report(0.2f);
    std::optional<CapsuleTree> capsules;
    if (skeleton != nullptr) capsules.emplace(*skeleton, mesh.origin, ctx);
    const CapsuleTree* tree = capsules ? &*capsules : nullptr;
    if (options.intersections || tree != nullptr) check_tree(mesh, skeleton, tree, options, ctx, report);
    ctx.throw_if_cancelled();
    ctx.report(0.9f);
    if (skeleton != nullptr) report.parts = compute_tree_components(mesh, *skeleton, ctx);
    ctx.throw_if_cancelled();
    if (tree != nullptr) {
        const VertexPlaces places = vertex_places(mesh, *skeleton, *tree, ctx);
        report.radius = radius_deviation(mesh, *tree, places, ctx);
        ctx.throw_if_cancelled();
        report.edge_flow = edge_flow(mesh, edges, *skeleton, *tree, places, ctx);
    }
    ctx.report(1);
    return report;
}

void list_fields(CheckOptions& o, FieldList& list) {
    list.add(common_field("intersections", "Find pairs of faces that cross each other."), o.intersections);
    list.add(
        Field{"max_intersections", "Maximum number of pairs of crossing faces after which the search stops.",
              Unit::none, 0, 1e9},
        o.max_intersections);
    list.add(Field{"max_places",
                   "Maximum number of places with crossing faces that are listed, the largest first.",
                   Unit::none, 0, 1e6},
             o.max_places);
    list.add(Field{"base", "Specified shape of the end of trees at a root with one child, for the volume."},
             o.base);
    list.add(Field{"tips", "Specified shape of the ends of branches, for the volume."}, o.tips);
}

}  // namespace coppice
