#include "coppice/pipeline/mesh_skeleton.h"

#include <fmt/format.h>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/field/convolution_field.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/pipeline/fit/fit_volume_internal.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/knots/remesh_knots_internal.h"
#include "coppice/pipeline/quad_origin_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {
namespace {

using pipeline_internal::KeptQuads;
using pipeline_internal::QuadOrigin;
using pipeline_internal::QuadRows;

// The map that follows one map by another; none stays none.
std::vector<NodeId> composed(std::span<const NodeId> first, std::span<const NodeId> second) {
    std::vector<NodeId> both(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i]) both[i] = second[first[i].index()];
    }
    return both;
}

// The skeleton as quads wrap it.
struct Wrapped {
    GraftResult grafted;
    PartResult parted;
    std::vector<NodeId> source;  // per node of the tubes: that of the field's skeleton
    std::vector<NodeId> tube;    // the other way around

    const Skeleton& tubes() const { return parted.skeleton; }
    const Skeleton& skeleton() const { return grafted.skeleton; }
};

Wrapped to_wrap(const Skeleton& prepared, const MeshOptions& options, const Context& ctx, Stages& stages) {
    const float graft = options.overlaps == Overlaps::graft ? options.graft : 0;
    GraftResult grafted = stages.run("graft", 0.08f, [&] { return graft_branches(prepared, graft, ctx); });
    PartResult parted = stages.run("part", 0.1f, [&] { return part_branches(grafted.tubes, ctx); });
    auto source = composed(parted.source, grafted.source);
    auto tube = composed(grafted.tube, parted.tube);
    return {std::move(grafted), std::move(parted), std::move(source), std::move(tube)};
}

// Boxes about the quads of the regions and their anchors.
std::vector<FieldRegion> field_regions(const ControlMesh& control, const Skeleton& skeleton) {
    std::vector<FieldRegion> regions(control.region_node.size());
    for (std::size_t f = 0; f < control.region.size(); ++f) {
        Box3& box = regions[control.region[f]].box;
        for (const std::uint32_t v : control.cage.quads[f]) {
            box.extend(control.cage.positions[v]);
            box.extend(control.anchors[v]);
        }
    }
    pipeline_internal::complete(regions, control.region_node, skeleton);
    return regions;
}

// Subdivides the cage of a surface, moves it onto the field, and unfolds it. Returns the vertices' anchors.
Buffer<Vec3> refine_cage(QuadSurface& out, int levels, ConvolutionField& field, const Wrapped& wrapped,
                         const MeshOptions& options, const Context& ctx, Stages& stages) {
    stages.run("field", 0.25f, [&] {
        field.set_regions(field_regions(out.cage, wrapped.skeleton()), {wrapped.tubes(), wrapped.tube}, ctx);
        return true;
    });
    const QuadMesh& cage = out.cage.cage;
    const PatchRefinement patches = stages.run("topology", 0.3f, [&] {
        return PatchRefinement(cage.quads, static_cast<std::uint32_t>(cage.positions.size()), levels, ctx);
    });
    out.mesh.origin = cage.origin;
    out.mesh.quads = stages.run("quads", 0.35f, [&] { return patches.quads(ctx); });
    out.mesh.positions = stages.run("refine", 0.45f, [&] { return patches.refine(cage.positions, ctx); });
    Buffer<Vec3> anchors =
        stages.run("anchors", 0.55f, [&] { return patches.refine(out.cage.anchors, ctx); });
    const ProjectionTarget target{FieldRef(field), out.cage.region, out.cage.clip};
    out.projected = stages.run("project", 0.85f, [&] {
        return project(out.mesh.positions, anchors, patches, target, options.project, ctx);
    });
    if (options.project.method != ProjectionMethod::none && levels > 0) {
        out.untangled = stages.run("untangle", 1.0f, [&] {
            return untangle({out.mesh.positions, anchors, out.mesh.quads}, patches, target, options.untangle,
                            ctx);
        });
    }
    return anchors;
}

BallReport balls_of(const ConvolutionField& field) {
    BallReport out{0, field.chain()};
    for (const auto& s : field.segments()) {
        if (s.weight > 0 && s.balls > 0) out.balls += static_cast<std::uint64_t>(s.balls) + 1;
    }
    return out;
}

void remesh(QuadSurface& out, const pipeline_internal::TubeMap& map, int levels, const MeshOptions& options,
            const Context& ctx, Stages& stages) {
    out.knots = stages.run("remesh", 1.0f,
                           [&] { return pipeline_internal::remesh_knots(out, map, levels, options, ctx); });
}

// Whether a tube is only the branch node at a root.
bool is_bare_root(const Skeleton& tubes, NodeId tube) { return tubes.is_root(tube) && !tubes.is_tip(tube); }

// `rows` and `origin` are made for those who move vertices later on.
QuadSurface mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                          std::optional<GlobalWeights>& weights, std::optional<QuadRows>& rows,
                          QuadOrigin* origin, const Context& ctx, Stages& stages) {
    QuadSurface out;
    const Wrapped wrapped = to_wrap(prepared, options, ctx, stages);
    out.grafted = wrapped.grafted.report;
    out.parted = wrapped.parted.report;
    out.cage = stages.run("cage", 0.15f, [&] {
        return build_control_mesh(wrapped.tubes(), wrapped.source, options.control, ctx);
    });
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        return surface_field(wrapped.skeleton(), options, constraints, weights, ctx);
    });
    if (options.field.kernel == Kernel::balls) out.balls = balls_of(field);
    Buffer<Vec3> anchors = refine_cage(out, options.levels, field, wrapped, options, ctx, stages);
    if (options.fit == Fit::volume) rows = QuadRows{out.mesh, wrapped.tubes(), options.levels};
    if (origin != nullptr) {
        *origin = {{out.mesh, wrapped.tubes(), options.levels},
                   std::move(anchors),
                   wrapped.skeleton(),
                   wrapped.source,
                   wrapped.tube};
    }
    const auto wrapping = compress_rows<NodeId>(wrapped.tube.size(), [&](const auto& put) {
        for (std::size_t n = 0; n < wrapped.tube.size(); ++n) {
            const NodeId tube = wrapped.tube[n];
            if (tube && !is_bare_root(wrapped.tubes(), tube)) put(n, tube);
        }
    });
    remesh(out, {wrapped.tubes(), wrapped.skeleton(), wrapped.source, wrapping}, options.levels, options, ctx,
           stages);
    return out;
}

QuadSurface mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                  const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                  std::optional<QuadRows>& rows, const Context& ctx, Stages& stages) {
    if (options.levels == 0)
        throw InvalidInput("mesh: levels must be at least 1 for ramifications, which are pasted between two");
    MeshOptions with = options;
    with.control.sides = 4;
    QuadSurface out;
    const Wrapped wrapped = to_wrap(prepared, options, ctx, stages);
    out.grafted = wrapped.grafted.report;
    out.parted = wrapped.parted.report;
    RamificationMesh made = stages.run("cage", 0.15f, [&] {
        return build_ramifications(wrapped.tubes(), options.control, options.levels, options.ramification,
                                   ctx);
    });
    out.ramified = made.report;
    // The field knows the tubes that the units were built of, the rows are those of what was made of them.
    out.cage = std::move(made.control);
    const std::vector<std::uint32_t> rows_of = out.cage.region;
    const std::vector<NodeId> source = std::exchange(out.cage.region_node, wrapped.source);
    for (std::uint32_t& r : out.cage.region) r = source[r].index();
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        return surface_field(wrapped.skeleton(), options, constraints, weights, ctx);
    });
    const int levels = options.levels - 1;
    refine_cage(out, levels, field, wrapped, options, ctx, stages);
    out.cage.region = rows_of;
    out.cage.region_node = composed(source, wrapped.source);
    if (options.fit == Fit::volume) rows = QuadRows{out.mesh, made.tubes, levels};
    const auto wrapping = compress_rows<NodeId>(wrapped.tube.size(), [&](const auto& put) {
        for (std::size_t n = 0; n < wrapped.tube.size(); ++n) {
            if (!wrapped.tube[n]) continue;
            for (const NodeId t : made.wrapping[wrapped.tube[n].index()]) put(n, t);
        }
    });
    remesh(out, {made.tubes, wrapped.skeleton(), out.cage.region_node, wrapping, made.sides}, levels, with,
           ctx, stages);
    return out;
}

CylinderMesh mesh_by_cylinders(const Skeleton& prepared, const MeshOptions& options, const Context& ctx,
                               Stages& stages) {
    const CylinderOptions tubes{.sides = options.control.sides << options.levels,
                                .rows = 1 << options.levels,
                                .thin = options.tube_sides,
                                .tips = options.control.tips,
                                .base = options.control.base};
    return stages.run("cylinders", 1.0f, [&] { return cylinders(prepared, tubes, ctx); });
}

EndShape base_end(const ControlOptions& o) {
    return o.base == BaseShape::round ? EndShape::round : EndShape::flat;
}
EndShape tip_end(const ControlOptions& o) {
    return o.tips == TipShape::round ? EndShape::round : EndShape::flat;
}

// Fits what was made; `rows` go with quads, but not with ramifications.
struct Fitting {
    const Skeleton& skeleton;
    const ControlOptions& ends;
    std::optional<QuadRows>& rows;
    const Context& ctx;

    FitVolumeReport operator()(QuadSurface& surface) const {
        if (!rows) return fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), ctx);
        KeptQuads kept(std::move(*rows), surface.cage, surface.mesh);
        const auto search = [&](const PolygonMesh& moved, std::uint32_t limit, const Context& c) {
            return kept.crossings(moved, limit, c);
        };
        return pipeline_internal::fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), search,
                                             ctx);
    }
    FitVolumeReport operator()(TetraSurface& surface) const {
        return fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), ctx);
    }
    FitVolumeReport operator()(CylinderMesh&) const {
        throw InvalidInput("mesh: fit must be surface for cylinders, which run through each other at forks");
    }
};

// Hundreds of branches that all begin at one point overlap for most of their length: a surface of them takes
// minutes and looks like none of them.
void check_branches(const Skeleton& s) {
    constexpr std::size_t kMost = 256;
    for (const NodeId n : nodes(s)) {
        const std::size_t count = s.children(n).size();
        if (count <= kMost) continue;
        const Vec3d at = Vec3d(s.position(n)) + s.origin();
        throw InvalidInput(
            fmt::format("mesh: {} branches begin at the node at {:.6g} {:.6g} {:.6g}, of which a surface can "
                        "join {}: let "
                        "them begin at nodes of their own along what they leave, or use the method cylinders",
                        count, at.x, at.y, at.z, kMost));
    }
}

// The quads that MeshMethod::bmesh stands for.
MeshOptions on_metaballs(MeshOptions options) {
    FieldOptions& field = options.field;
    if (field.kernel != Kernel::quartic && field.kernel != Kernel::balls)
        throw InvalidInput("mesh: kernel must be quartic or balls for bmesh, whose balls are quartic");
    field.kernel = Kernel::balls;
    field.blend = 1;
    options.method = MeshMethod::quads;
    return options;
}

MeshResult make_mesh(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& given,
                     bool with_solid, QuadOrigin* origin, const Context& ctx) {
    check_fields(given, "mesh");
    const MeshOptions options = given.method == MeshMethod::bmesh ? on_metaballs(given) : given;
    MeshResult out;
    const bool fits = options.fit == Fit::volume;
    const Context meshing = fits ? part_of(ctx, 0, 0.5f) : ctx;
    Stages stages(meshing, out.stages);
    const PrepareResult prepared =
        stages.run("prepare", 0.05f, [&] { return prepare(skeleton, options.prepare); });
    out.prepared = prepared.report;
    if (options.method != MeshMethod::cylinders) check_branches(prepared.skeleton);
    std::optional<QuadRows> rows;
    if (options.method == MeshMethod::quads) {
        out.surface = mesh_by_quads(prepared.skeleton, constraints, options, out.weights, rows, origin,
                                    meshing, stages);
    } else if (options.method == MeshMethod::ramifications) {
        out.surface = mesh_by_ramifications(prepared.skeleton, constraints, options, out.weights, rows,
                                            meshing, stages);
    } else if (options.method == MeshMethod::cylinders) {
        out.surface = mesh_by_cylinders(prepared.skeleton, options, meshing, stages);
    } else {
        const auto make = with_solid ? solid_by_tetrahedra : mesh_by_tetrahedra;
        out.surface = make(prepared.skeleton, constraints, options, out.weights, meshing, stages);
    }
    if (fits) {
        const Context fitting = part_of(ctx, 0.5f, 1);
        out.fitted = Stages(fitting, out.stages).run("fit", 1.0f, [&] {
            return std::visit(Fitting{skeleton, options.control, rows, fitting}, out.surface);
        });
    }
    return out;
}

PolygonMesh polygons_of(const PolygonMesh& mesh) { return mesh; }
template <class Mesh>
PolygonMesh polygons_of(const Mesh& mesh) {
    return to_polygons(mesh);
}

}  // namespace

PolygonMesh to_polygons(const MeshResult& result) {
    return std::visit([](const auto& surface) { return polygons_of(surface.mesh); }, result.surface);
}

MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx) {
    return mesh_skeleton(skeleton, PointSet{}, options, ctx);
}

MeshResult mesh_skeleton(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx) {
    return make_mesh(skeleton, constraints, options, false, nullptr, ctx);
}

MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                      const Context& ctx) {
    if (options.method != MeshMethod::tetrahedra)
        throw InvalidInput("mesh: method must be tetrahedra for the tetrahedra inside");
    if (options.fit != Fit::surface)
        throw InvalidInput("mesh: fit must be surface for the tetrahedra inside, which would not move along");
    return make_mesh(skeleton, constraints, options, true, nullptr, ctx);
}

namespace pipeline_internal {

void complete(std::vector<FieldRegion>& regions, std::span<const NodeId> seeds, const Skeleton& skeleton) {
    constexpr float kMargin = 0.3f;  // [radii]
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].seed = seeds[r];
        if (!regions[r].box.empty())
            regions[r].box = regions[r].box.inflated(kMargin * skeleton.radius(seeds[r]));
    }
}

MeshResult mesh_with_origin(const Skeleton& skeleton, const MeshOptions& options, QuadOrigin& origin,
                            const Context& ctx) {
    return make_mesh(skeleton, {}, options, false, &origin, ctx);
}

}  // namespace pipeline_internal

}  // namespace coppice
