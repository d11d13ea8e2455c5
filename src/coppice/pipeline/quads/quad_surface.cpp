#include "coppice/pipeline/quads/quad_surface_internal.h"

#include <fmt/format.h>

#include <utility>

#include "coppice/field/convolution_field.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/pipeline/coarsen/coarsen_quads_internal.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/pipeline/quads/blunt_tips_internal.h"
#include "coppice/pipeline/quads/quads_on_device_internal.h"
#include "coppice/pipeline/repair/repair_intersections_internal.h"
#include "coppice/pipeline/surface_field_internal.h"

namespace coppice {
namespace {

// Returns the composition of two maps; none is mapped to none.
std::vector<NodeId> composed(std::span<const NodeId> first, std::span<const NodeId> second) {
    std::vector<NodeId> both(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i]) both[i] = second[first[i].index()];
    }
    return both;
}

SectionEnd piece_end(const MeshOptions& options) {
    return options.overlaps == Overlaps::merge ? SectionEnd::joined : SectionEnd::closed;
}

// A surface without a cage, and the inputs of its cage.
struct Wrapped {
    BuiltQuads built;
    std::vector<NodeId> source;       // per tube: the node of the field's skeleton
    std::vector<NodeId> round_roots;  // see SeparatedSkeleton
    std::vector<NodeJoin> joins;      // of tubes
};

Wrapped to_wrap(const Skeleton& prepared, const MeshOptions& options, SectionEnd end, const Context& ctx,
                Stages& stages) {
    const float graft = options.overlaps == Overlaps::keep ? 0 : options.graft;
    GraftResult grafted =
        stages.run("graft", 0.08f, [&] { return graft_branches(prepared, graft, end, ctx); });
    SeparatedSkeleton parted =
        stages.run("part", 0.1f, [&] { return separate_branches(grafted.tubes, grafted.joins, ctx); });
    Wrapped out{.built = {},
                .source = composed(parted.source, grafted.source),
                .round_roots = std::move(parted.round_roots),
                .joins = std::move(parted.joins)};
    out.built.surface.grafted = grafted.report;
    out.built.surface.parted = parted.report;
    QuadBuild& build = out.built.build;
    build.options = options;
    build.field = surface_field_options(options);
    build.skeleton = std::move(grafted.skeleton);
    build.prepared_node = std::move(grafted.segment);
    build.tubes = std::move(parted.skeleton);
    build.tube = composed(grafted.tube, parted.tube);
    return out;
}

BuiltQuads with_cage(const Skeleton& prepared, const MeshOptions& options, SectionEnd end, const Context& ctx,
                     Stages& stages) {
    Wrapped wrapped = to_wrap(prepared, options, end, ctx, stages);
    QuadBuild& build = wrapped.built.build;
    build.cage = stages.run("cage", 0.15f, [&] {
        return build_control_mesh(build.tubes, wrapped.source, options.control, ctx, wrapped.round_roots,
                                  wrapped.joins);
    });
    return std::move(wrapped.built);
}

// Subdivides the cage of a surface, moves it onto the field, and unfolds it.
class CageRefiner {
  public:
    CageRefiner(BuiltQuads& built, ConvolutionField& field, const Context& ctx, Stages& stages)
        : out_(built.surface), build_(built.build), field_(field), ctx_(ctx), stages_(stages) {}

    void run(int levels) {
        const QuadMesh& cage = build_.cage.cage;
        build_.refinement = stages_.run("topology", 0.3f, [&] {
            const auto vertices = static_cast<std::uint32_t>(cage.positions.size());
            return PatchRefinement(cage.quads, vertices, levels, ctx_);
        });
        out_.mesh.origin = cage.origin;
        std::optional<DeviceQuads> device = begin_on_card();
        // The GPU works in parallel.
        out_.mesh.quads = stages_.run("quads", 0.35f, [&] { return build_.refinement.quads(ctx_); });
        if (!device || !finish_on_card(*device)) refine_here();
        build_.refined = out_.mesh.positions;
    }

  private:
    // Regions of the field, for the work that is not done on the GPU.
    void set_regions() {
        if (has_regions_) return;
        field_.set_regions(pipeline_internal::field_regions(build_.cage, build_.skeleton), tubes(), ctx_);
        has_regions_ = true;
    }

    std::optional<DeviceQuads> begin_on_card() {
        const PatchRefinement& patches = build_.refinement;
        const MeshOptions& options = build_.options;
        if (!goes_to_device(options.device, patches.quad_count(), out_.device)) return {};
        const ControlMesh& cage = build_.cage;
        const cuda::QuadJob job{patches.cage(), patches.levels(), cage.cage.positions, cage.anchors,
                                cage.region,    cage.clip,        options.project,     options.untangle};
        const cuda::ContactInput contacts{build_.skeleton, tubes(), field_, cage};
        return stages_.run("send", 0.3f, [&] {
            return begin_on_device(
                job, contacts, [&] { set_regions(); }, out_.device, ctx_);
        });
    }

    bool finish_on_card(DeviceQuads& device) {
        std::optional<cuda::QuadReport> done = stages_.run("device", 0.9f, [&] {
            return on_device(out_.device,
                             [&] { return device.finish(out_.mesh.positions, &build_.anchors); });
        });
        if (!done) return false;
        out_.projected = done->projected;
        out_.untangled = std::move(done->untangled);
        if (!done->is_whole) {
            find_regions(0.95f);
            unfold();
        }
        return true;
    }

    void refine_here() {
        find_regions(0.4f);
        const PatchRefinement& patches = build_.refinement;
        out_.mesh.positions =
            stages_.run("refine", 0.45f, [&] { return patches.refine(build_.cage.cage.positions, ctx_); });
        build_.anchors =
            stages_.run("anchors", 0.55f, [&] { return patches.refine(build_.cage.anchors, ctx_); });
        out_.projected = stages_.run("project", 0.85f, [&] {
            return project(out_.mesh.positions, build_.anchors, patches, target(), build_.options.project,
                           ctx_);
        });
        unfold();
    }

    void find_regions(float progress_after) {
        stages_.run("field", progress_after, [&] {
            set_regions();
            return true;
        });
    }

    void unfold() {
        if (build_.options.project.method == ProjectionMethod::none) return;
        out_.untangled = stages_.run("untangle", 1.0f, [&] {
            return untangle({out_.mesh.positions, build_.anchors, out_.mesh.quads}, build_.refinement,
                            target(), build_.options.untangle, ctx_);
        });
    }

    TubeTree tubes() const { return {build_.tubes, build_.tube, build_.cage.joins}; }
    ProjectionTarget target() const { return {FieldRef(field_), build_.cage.region, build_.cage.clip}; }

    QuadSurface& out_;
    QuadBuild& build_;
    ConvolutionField& field_;
    const Context& ctx_;
    Stages& stages_;
    bool has_regions_ = false;
};

BallReport compute_balls(const ConvolutionField& field) {
    BallReport out{0, field.chain()};
    for (const auto& s : field.segments()) {
        if (s.weight > 0 && s.balls > 0) out.balls += static_cast<std::uint64_t>(s.balls) + 1;
    }
    return out;
}

// Refines the cage of a surface and moves it onto the field.
void refine(BuiltQuads& out, int levels, const PointSet& constraints, const Context& ctx, Stages& stages) {
    QuadBuild& build = out.build;
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        ConvolutionField made(build.skeleton, build.field, ctx);
        build.weights = apply_global_weights(made, build.skeleton, build.field, constraints, ctx);
        return made;
    });
    if (build.field.kernel == Kernel::balls) out.surface.balls = compute_balls(field);
    CageRefiner(out, field, ctx, stages).run(levels);
}

// Applies the joins of trees to the counts: each joins two bodies, or closes a loop.
void count_bodies(const Skeleton& tubes, std::span<const NodeJoin> joins, RemeshReport& out) {
    const std::vector<NodeId> root = pipeline_internal::body_roots(tubes, joins);
    for (const NodeId n : nodes(tubes)) out.parts += root[n.index()] == n ? 1 : 0;
    out.handles = std::ssize(joins) + static_cast<std::int64_t>(out.parts) - tubes.tree_count();
}

// Returns whether quads around thin branches become fewer.
bool is_coarsened(TubeSides sides, int levels) { return sides == TubeSides::by_radius && levels > 0; }

// `wanted`: per tube whether it is checked; empty for all.
void remesh_and_coarsen(BuiltQuads& out, std::span<const std::uint8_t> wanted, const Context& ctx,
                        Stages& stages) {
    QuadSurface& surface = out.surface;
    QuadBuild& build = out.build;
    surface.repair = stages.run("remesh", 1.0f, [&] {
        pipeline_internal::RemeshResult remeshed =
            pipeline_internal::repair_intersections(surface.mesh, surface.untangled, build, wanted, ctx);
        build.remeshed = std::move(remeshed.trace);
        return remeshed.report;
    });
    if (surface.repair.rounds == 0) count_bodies(build.tubes, build.cage.joins, surface.repair);
    if (!is_coarsened(build.options.tube_sides, build.refinement.levels())) return;
    surface.coarsened = stages.run(
        "coarsen", 1.0f, [&] { return pipeline_internal::coarsen_quads(surface.mesh, build, ctx); });
}

// Returns whether a tube is only the branch node at a root.
bool is_bare_root(const Skeleton& tubes, NodeId tube) { return tubes.is_root(tube) && !tubes.is_tip(tube); }

// Without levels, the cage has no vertices to round a tip, so that its tubes end in planes there.
void shape_tips(BuiltQuads& out) {
    pipeline_internal::shape_blunt_tips(
        out.build.cage, out.build.tubes, [](NodeId) { return true; },
        [&](std::uint32_t v) -> Vec3& { return out.surface.mesh.positions[v]; });
    out.build.refined = out.surface.mesh.positions;
}

BuiltQuads mesh_with(SectionEnd end, const Skeleton& prepared, const PointSet& constraints,
                     const MeshOptions& options, const QuadUse& use, const Context& ctx, Stages& stages) {
    BuiltQuads out = with_cage(prepared, options, end, ctx, stages);
    QuadBuild& build = out.build;
    refine(out, options.levels, constraints, ctx, stages);
    // A surface that moves along with its skeleton is projected again in each pose.
    if (options.levels == 0 && options.control.tips == TipShape::round && !use.is_posed &&
        options.project.method != ProjectionMethod::none)
        shape_tips(out);
    build.wrapping = compress_rows<NodeId>(build.tube.size(), [&](const auto& put) {
        for (std::size_t n = 0; n < build.tube.size(); ++n) {
            const NodeId tube = build.tube[n];
            if (tube && !is_bare_root(build.tubes, tube)) put(n, tube);
        }
    });
    std::vector<std::uint8_t> wanted;
    if (use.wanted) wanted = use.wanted(out.surface.mesh, build);
    remesh_and_coarsen(out, wanted, ctx, stages);
    return out;
}

}  // namespace

QuadBuild build_cage(const Skeleton& prepared, const MeshOptions& options, const Context& ctx) {
    std::vector<std::pair<std::string, double>> seconds;
    Stages stages(ctx, seconds);
    return with_cage(prepared, options, piece_end(options), ctx, stages).build;
}

BuiltQuads mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                         const QuadUse& use, const Context& ctx, Stages& stages) {
    if (is_coarsened(options.tube_sides, options.levels) && (use.is_posed || use.wanted))
        throw InvalidInput("mesh: tube_sides must be equal for a surface that follows its skeleton");
    const auto mesh = [&](SectionEnd end) {
        return mesh_with(end, prepared, constraints, options, use, ctx, stages);
    };
    const SectionEnd end = piece_end(options);
    BuiltQuads out = mesh(end);
    const std::uint64_t pairs = out.surface.repair.pairs_after;
    if (end == SectionEnd::closed || pairs == 0) return out;
    // Crowds of branches within each other, which cannot be merged into one body.
    out = mesh(SectionEnd::closed);
    if (out.surface.repair.pairs_after >= pairs) out = mesh(end);
    return out;
}

BuiltQuads mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                 const MeshOptions& options, const Context& ctx, Stages& stages) {
    if (options.levels == 0)
        throw InvalidInput("mesh: levels must be at least 1 for ramifications, which are pasted between two");
    // Units have no tubes that end in others.
    Wrapped wrapped = to_wrap(prepared, options, SectionEnd::closed, ctx, stages);
    BuiltQuads out = std::move(wrapped.built);
    QuadBuild& build = out.build;
    build.options.control.sides = 4;
    RamificationMesh made = stages.run("cage", 0.15f, [&] {
        return build_ramifications(build.tubes, options.control, options.levels, options.ramification, ctx,
                                   wrapped.round_roots);
    });
    out.surface.ramified = made.report;
    // The field uses the tubes from which the units were built, the rows those of the result.
    build.cage = std::move(made.control);
    const std::vector<std::uint32_t> row_regions = build.cage.region;
    const std::vector<NodeId> unit_tube = std::exchange(build.cage.region_node, wrapped.source);
    for (std::uint32_t& r : build.cage.region) r = unit_tube[r].index();
    refine(out, options.levels - 1, constraints, ctx, stages);
    build.cage.region = row_regions;
    build.cage.region_node = composed(unit_tube, wrapped.source);
    build.tubes = std::move(made.tubes);
    build.sides = std::move(made.sides);
    const std::vector<NodeId> tube = std::exchange(build.tube, {});
    build.wrapping = compress_rows<NodeId>(tube.size(), [&](const auto& put) {
        for (std::size_t n = 0; n < tube.size(); ++n) {
            if (!tube[n]) continue;
            for (const NodeId t : made.wrapping[tube[n].index()]) put(n, t);
        }
    });
    remesh_and_coarsen(out, {}, ctx, stages);
    return out;
}

// Hundreds of branches that all begin at one point overlap for most of their length: a surface of them needs
// minutes and resembles none of them.
void check_branches(const Skeleton& s) {
    constexpr std::size_t kMax = 256;
    for (const NodeId n : nodes(s)) {
        const std::size_t count = s.children(n).size();
        if (count <= kMax) continue;
        const Vec3d at = Vec3d(s.position(n)) + s.origin();
        throw InvalidInput(fmt::format(
            "mesh: {} branches begin at the node at {:.6g} {:.6g} {:.6g}, but a surface can join at most {}: "
            "let them begin at separate nodes along their parent, or use the method cylinders",
            count, at.x, at.y, at.z, kMax));
    }
}

// The options of quads for MeshMethod::bmesh.
MeshOptions on_metaballs(MeshOptions options) {
    FieldOptions& field = options.field;
    if (field.kernel != Kernel::quartic && field.kernel != Kernel::balls)
        throw InvalidInput("mesh: kernel must be quartic or balls for bmesh, which uses quartic balls");
    field.kernel = Kernel::balls;
    field.blend = 1;
    options.method = MeshMethod::quads;
    return options;
}

}  // namespace coppice
