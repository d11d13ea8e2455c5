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
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {
namespace {

using pipeline_internal::KeptQuads;
using pipeline_internal::QuadRows;

// The field of a region is asked about the points of its quads, and a little beyond.
std::vector<FieldRegion> field_regions(const ControlMesh& control, const Skeleton& skeleton) {
    constexpr float kMargin = 0.3f;  // [radii]
    std::vector<FieldRegion> regions(control.region_node.size());
    for (std::size_t f = 0; f < control.region.size(); ++f) {
        Box3& box = regions[control.region[f]].box;
        for (const std::uint32_t v : control.cage.quads[f]) {
            box.extend(control.cage.positions[v]);
            box.extend(control.anchors[v]);
        }
    }
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].seed = control.region_node[r];
        if (!regions[r].box.empty()) {
            regions[r].box = regions[r].box.inflated(kMargin * skeleton.radius(regions[r].seed));
        }
    }
    return regions;
}

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

// Subdivides the cage of a surface, moves it onto the field, and unfolds it.
void refine_cage(QuadSurface& out, int levels, ConvolutionField& field, const Wrapped& wrapped,
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
    const Buffer<Vec3> anchors =
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
}

// `rows` are made for those who move vertices later on.
QuadSurface mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                          std::optional<GlobalWeights>& weights, std::optional<QuadRows>& rows,
                          const Context& ctx, Stages& stages) {
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
    refine_cage(out, options.levels, field, wrapped, options, ctx, stages);
    if (options.fit == Fit::volume) rows = QuadRows{out.mesh, wrapped.tubes(), options.levels};
    const pipeline_internal::TubeMap map{wrapped.tubes(), wrapped.skeleton(), wrapped.source, wrapped.tube};
    out.knots =
        stages.run("remesh", 1.0f, [&] { return pipeline_internal::remesh_knots(out, map, options, ctx); });
    return out;
}

// The refined quads of flat ends.
std::vector<std::uint32_t> flat_ends(std::span<const ClipPlane> clips, int levels) {
    std::vector<std::uint32_t> quads;
    for (const ClipPlane& c : clips) {
        const std::uint32_t end = (c.first_quad + c.quad_count) << (2 * levels);
        for (std::uint32_t q = c.first_quad << (2 * levels); q < end; ++q) quads.push_back(q);
    }
    return quads;
}

// The nodes about which quads still cross, of the tubes, ascending.
std::vector<NodeId> crossing_nodes(const QuadSurface& surface, int levels, const Skeleton& tubes) {
    std::vector<NodeId> nodes;
    for (const std::uint32_t q : surface.smoothed.left) {
        const NodeId n(surface.cage.region[q >> (2 * levels)]);
        nodes.push_back(n);
        if (!tubes.is_root(n)) nodes.push_back(tubes.parent(n));
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

// A second time where quads still cross, with the laterals there pasted; the better of both.
QuadSurface mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                  const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                  const Context& ctx, Stages& stages) {
    if (options.levels == 0)
        throw InvalidInput("mesh: levels must be at least 1 for ramifications, which are pasted between two");
    const Wrapped wrapped = to_wrap(prepared, options, ctx, stages);
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        return surface_field(wrapped.skeleton(), options, constraints, weights, ctx);
    });
    const int levels = options.levels - 1;
    const bool smooths = options.remesh_rounds > 0 && options.overlaps != Overlaps::keep &&
                         options.project.method != ProjectionMethod::none;
    const auto attempt = [&](std::span<const NodeId> pasted, const Context& how, Stages& steps) {
        QuadSurface out;
        out.grafted = wrapped.grafted.report;
        out.parted = wrapped.parted.report;
        out.cage = steps.run("cage", 0.2f, [&] {
            const RamificationInput input{wrapped.tubes(), wrapped.source, pasted};
            RamificationMesh made =
                build_ramifications(input, options.control, options.levels, options.ramification, how);
            out.ramified = made.report;
            return std::move(made.control);
        });
        refine_cage(out, levels, field, wrapped, options, how, steps);
        if (smooths) {
            out.smoothed = steps.run("smooth", 1.0f, [&] {
                return smooth_crossings(out.mesh, flat_ends(out.cage.clip, levels), how);
            });
        }
        return out;
    };
    QuadSurface out = attempt({}, ctx, stages);
    if (out.smoothed.pairs_after == 0) return out;
    const Context quiet{.threads = ctx.threads, .stop = ctx.stop};
    Stages again = stages.with(quiet);
    QuadSurface pasted = attempt(crossing_nodes(out, levels, wrapped.tubes()), quiet, again);
    return pasted.smoothed.pairs_after < out.smoothed.pairs_after ? std::move(pasted) : std::move(out);
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

MeshResult make_mesh(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                     bool with_solid, const Context& ctx) {
    check_fields(options, "mesh");
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
        out.surface =
            mesh_by_quads(prepared.skeleton, constraints, options, out.weights, rows, meshing, stages);
    } else if (options.method == MeshMethod::ramifications) {
        out.surface =
            mesh_by_ramifications(prepared.skeleton, constraints, options, out.weights, meshing, stages);
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
    return make_mesh(skeleton, constraints, options, false, ctx);
}

MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                      const Context& ctx) {
    if (options.method != MeshMethod::tetrahedra)
        throw InvalidInput("mesh: method must be tetrahedra for the tetrahedra inside");
    if (options.fit != Fit::surface)
        throw InvalidInput("mesh: fit must be surface for the tetrahedra inside, which would not move along");
    return make_mesh(skeleton, constraints, options, true, ctx);
}

}  // namespace coppice
