#include "coppice/pipeline/quads/quad_surface_internal.h"

#include <fmt/format.h>

#include <cmath>

#include "coppice/field/convolution_field.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/pipeline/coarsen/coarsen_quads_internal.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/pipeline/quads/blunt_tips_internal.h"
#include "coppice/pipeline/quads/quads_on_device_internal.h"
#include "coppice/pipeline/surface_field_internal.h"

namespace coppice {
namespace {

using pipeline_internal::QuadRows;
using pipeline_internal::RemeshTrace;
using pipeline_internal::TubeMap;

// Returns the composition of two maps; none is mapped to none.
std::vector<NodeId> composed(std::span<const NodeId> first, std::span<const NodeId> second) {
    std::vector<NodeId> both(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i]) both[i] = second[first[i].index()];
    }
    return both;
}

// The skeleton that the quads wrap.
struct Wrapped {
    GraftResult grafted;
    PartResult parted;
    std::vector<NodeId> source;  // per node of the tubes: the node of the field's skeleton
    std::vector<NodeId> tube;    // inverse of source

    const Skeleton& tubes() const { return parted.skeleton; }
    const Skeleton& skeleton() const { return grafted.skeleton; }
};

PieceEnd piece_end(const MeshOptions& options) {
    return options.overlaps == Overlaps::merge ? PieceEnd::joined : PieceEnd::closed;
}

Wrapped to_wrap(const Skeleton& prepared, const MeshOptions& options, PieceEnd end, const Context& ctx,
                Stages& stages) {
    const float graft = options.overlaps == Overlaps::keep ? 0 : options.graft;
    GraftResult grafted =
        stages.run("graft", 0.08f, [&] { return graft_branches(prepared, graft, end, ctx); });
    PartResult parted =
        stages.run("part", 0.1f, [&] { return part_branches(grafted.tubes, grafted.joins, ctx); });
    auto source = composed(parted.source, grafted.source);
    auto tube = composed(grafted.tube, parted.tube);
    return {std::move(grafted), std::move(parted), std::move(source), std::move(tube)};
}

ControlMesh cage_about(const Wrapped& wrapped, const MeshOptions& options, const Context& ctx) {
    return build_control_mesh(wrapped.tubes(), wrapped.source, options.control, ctx,
                              wrapped.parted.round_roots, wrapped.parted.joins);
}

// The refinement of a cage.
struct Refined {
    PatchRefinement patches;
    Buffer<Vec3> anchors;  // per refined vertex
};

// Subdivides the cage of a surface, moves it onto the field, and unfolds it.
class CageRefiner {
  public:
    CageRefiner(QuadSurface& out, int levels, ConvolutionField& field, const Wrapped& wrapped,
                const MeshOptions& options, const Context& ctx, Stages& stages)
        : out_(out),
          levels_(levels),
          field_(field),
          wrapped_(wrapped),
          options_(options),
          ctx_(ctx),
          stages_(stages) {}

    Refined run() {
        const QuadMesh& cage = out_.cage.cage;
        Refined refined{stages_.run("topology", 0.3f,
                                    [&] {
                                        const auto vertices =
                                            static_cast<std::uint32_t>(cage.positions.size());
                                        return PatchRefinement(cage.quads, vertices, levels_, ctx_);
                                    }),
                        {}};
        out_.mesh.origin = cage.origin;
        std::optional<DeviceQuads> device = begin_on_card(refined.patches);
        // The GPU works in parallel.
        out_.mesh.quads = stages_.run("quads", 0.35f, [&] { return refined.patches.quads(ctx_); });
        if (!device || !finish_on_card(*device, refined)) refine_here(refined);
        return refined;
    }

  private:
    // Regions of the field, for the work that is not done on the GPU.
    void set_regions() {
        if (has_regions_) return;
        field_.set_regions(pipeline_internal::field_regions(out_.cage, wrapped_.skeleton()),
                           {wrapped_.tubes(), wrapped_.tube, out_.cage.joins}, ctx_);
        has_regions_ = true;
    }

    std::optional<DeviceQuads> begin_on_card(const PatchRefinement& patches) {
        if (!goes_to_device(options_.device, patches.quad_count(), out_.device)) return {};
        const ControlMesh& cage = out_.cage;
        const cuda::QuadJob job{patches.cage(), levels_,   cage.cage.positions, cage.anchors,
                                cage.region,    cage.clip, options_.project,    options_.untangle};
        const cuda::ContactInput contacts{
            wrapped_.skeleton(), {wrapped_.tubes(), wrapped_.tube, cage.joins}, field_, cage};
        return stages_.run("send", 0.3f, [&] {
            return begin_on_device(
                job, contacts, [&] { set_regions(); }, out_.device, ctx_);
        });
    }

    bool finish_on_card(DeviceQuads& device, Refined& refined) {
        std::optional<cuda::QuadReport> done = stages_.run("device", 0.9f, [&] {
            return on_device(out_.device,
                             [&] { return device.finish(out_.mesh.positions, &refined.anchors); });
        });
        if (!done) return false;
        out_.projected = done->projected;
        out_.untangled = std::move(done->untangled);
        if (!done->is_whole) {
            find_regions(0.95f);
            unfold(refined);
        }
        return true;
    }

    void refine_here(Refined& refined) {
        find_regions(0.4f);
        const PatchRefinement& patches = refined.patches;
        out_.mesh.positions =
            stages_.run("refine", 0.45f, [&] { return patches.refine(out_.cage.cage.positions, ctx_); });
        refined.anchors =
            stages_.run("anchors", 0.55f, [&] { return patches.refine(out_.cage.anchors, ctx_); });
        out_.projected = stages_.run("project", 0.85f, [&] {
            return project(out_.mesh.positions, refined.anchors, patches, target(), options_.project, ctx_);
        });
        unfold(refined);
    }

    void find_regions(float progress_after) {
        stages_.run("field", progress_after, [&] {
            set_regions();
            return true;
        });
    }

    void unfold(const Refined& refined) {
        if (options_.project.method == ProjectionMethod::none) return;
        out_.untangled = stages_.run("untangle", 1.0f, [&] {
            return untangle({out_.mesh.positions, refined.anchors, out_.mesh.quads}, refined.patches,
                            target(), options_.untangle, ctx_);
        });
    }

    ProjectionTarget target() const { return {FieldRef(field_), out_.cage.region, out_.cage.clip}; }

    QuadSurface& out_;
    int levels_;
    ConvolutionField& field_;
    const Wrapped& wrapped_;
    const MeshOptions& options_;
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

// Applies the joins of trees to the counts: each joins two bodies, or closes a loop.
void count_bodies(const Skeleton& tubes, std::span<const NodeJoin> joins, RemeshReport& out) {
    const std::vector<NodeId> root = pipeline_internal::body_roots(tubes, joins);
    for (const NodeId n : nodes(tubes)) out.parts += root[n.index()] == n ? 1 : 0;
    out.handles = std::ssize(joins) + static_cast<std::int64_t>(out.parts) - tubes.tree_count();
}

void remesh(QuadSurface& out, const TubeMap& map, int levels, const MeshOptions& options, const Context& ctx,
            Stages& stages, RemeshTrace* trace, std::span<const std::uint8_t> wanted = {}) {
    out.repair = stages.run(
        "remesh", 1.0f, [&] { return repair_intersections(out, map, levels, options, ctx, trace, wanted); });
    if (out.repair.rounds == 0) count_bodies(map.tubes, out.cage.joins, out.repair);
}

// Returns whether quads around thin branches become fewer.
bool is_coarsened(const MeshOptions& options) {
    return options.tube_sides == TubeSides::by_radius && options.levels > 0;
}

void remesh_and_coarsen(QuadSurface& out, const TubeMap& map, const Refined& refined,
                        const MeshOptions& options, const Context& ctx, Stages& stages) {
    RemeshTrace remeshed;
    remesh(out, map, refined.patches.levels(), options, ctx, stages, &remeshed);
    const pipeline_internal::RefinedQuads from{map, refined.patches, refined.anchors, remeshed};
    out.coarsened = stages.run("coarsen", 1.0f, [&] { return coarsen_quads(out, from, options, ctx); });
}

// Returns whether a tube is only the branch node at a root.
bool is_bare_root(const Skeleton& tubes, NodeId tube) { return tubes.is_root(tube) && !tubes.is_tip(tube); }

// Without levels, the cage has no vertices to round a tip, so that its tubes end in planes there.
void shape_tips(QuadSurface& out, const Skeleton& tubes) {
    pipeline_internal::shape_blunt_tips(
        out.cage, tubes, [](NodeId) { return true; },
        [&](std::uint32_t v) -> Vec3& { return out.mesh.positions[v]; });
}

QuadSurface mesh_with(PieceEnd end, const Skeleton& prepared, const PointSet& constraints,
                      const MeshOptions& options, const QuadExtras& extras, const Context& ctx,
                      Stages& stages) {
    if (extras.trace != nullptr) *extras.trace = {};  // discards previous results
    QuadSurface out;
    const Wrapped wrapped = to_wrap(prepared, options, end, ctx, stages);
    out.grafted = wrapped.grafted.report;
    out.parted = wrapped.parted.report;
    out.cage = stages.run("cage", 0.15f, [&] { return cage_about(wrapped, options, ctx); });
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        return surface_field(wrapped.skeleton(), options, constraints, extras.weights, ctx);
    });
    if (options.field.kernel == Kernel::balls) out.balls = compute_balls(field);
    Refined refined = CageRefiner(out, options.levels, field, wrapped, options, ctx, stages).run();
    // A surface that moves along with its skeleton is projected again in each pose.
    if (options.levels == 0 && options.control.tips == TipShape::round && extras.origin == nullptr &&
        options.project.method != ProjectionMethod::none)
        shape_tips(out, wrapped.tubes());
    if (extras.rows != nullptr && !is_coarsened(options))
        *extras.rows = QuadRows{out.mesh, wrapped.tubes(), options.levels};
    if (extras.origin != nullptr) {
        *extras.origin = {{out.mesh, wrapped.tubes(), options.levels},
                          std::move(refined.anchors),
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
    QuadTrace* const trace = extras.trace;
    std::vector<std::uint8_t> wanted;
    if (trace != nullptr) {
        trace->segment = composed(wrapped.source, wrapped.grafted.segment);
        trace->field_segment = wrapped.grafted.segment;
        trace->patches = std::move(refined.patches);
        trace->tubes = wrapped.tubes();
        trace->refined = out.mesh.positions;
        if (extras.wanted) wanted = extras.wanted(out, *trace);
    }
    const TubeMap map{wrapped.tubes(), wrapped.skeleton(), wrapped.source, wrapping};
    if (is_coarsened(options)) {
        remesh_and_coarsen(out, map, refined, options, ctx, stages);
    } else {
        remesh(out, map, options.levels, options, ctx, stages, trace != nullptr ? &trace->remeshed : nullptr,
               wanted);
    }
    return out;
}

}  // namespace

TubeCage compute_cage(const Skeleton& prepared, const MeshOptions& options, const Context& ctx) {
    std::vector<std::pair<std::string, double>> seconds;
    Stages stages(ctx, seconds);
    Wrapped wrapped = to_wrap(prepared, options, piece_end(options), ctx, stages);
    ControlMesh control = cage_about(wrapped, options, ctx);
    return {std::move(control), std::move(wrapped.parted.skeleton)};
}

QuadSurface mesh_by_quads(const Skeleton& prepared, const PointSet& constraints, const MeshOptions& options,
                          const QuadExtras& extras, const Context& ctx, Stages& stages) {
    if (is_coarsened(options) && (extras.origin != nullptr || extras.trace != nullptr))
        throw InvalidInput("mesh: tube_sides must be equal for a surface that follows its skeleton");
    const auto mesh = [&](PieceEnd end) {
        return mesh_with(end, prepared, constraints, options, extras, ctx, stages);
    };
    const PieceEnd end = piece_end(options);
    QuadSurface out = mesh(end);
    if (end == PieceEnd::closed || out.repair.pairs_after == 0) return out;
    // Crowds of branches within each other, which cannot be merged into one body.
    QuadSurface grafted = mesh(PieceEnd::closed);
    return grafted.repair.pairs_after < out.repair.pairs_after ? std::move(grafted) : mesh(end);
}

QuadSurface mesh_by_ramifications(const Skeleton& prepared, const PointSet& constraints,
                                  const MeshOptions& options, const QuadExtras& extras, const Context& ctx,
                                  Stages& stages) {
    if (options.levels == 0)
        throw InvalidInput("mesh: levels must be at least 1 for ramifications, which are pasted between two");
    MeshOptions with = options;
    with.control.sides = 4;
    QuadSurface out;
    // Units have no tubes that end in others.
    const Wrapped wrapped = to_wrap(prepared, options, PieceEnd::closed, ctx, stages);
    out.grafted = wrapped.grafted.report;
    out.parted = wrapped.parted.report;
    RamificationMesh made = stages.run("cage", 0.15f, [&] {
        return build_ramifications(wrapped.tubes(), options.control, options.levels, options.ramification,
                                   ctx, wrapped.parted.round_roots);
    });
    out.ramified = made.report;
    // The field uses the tubes from which the units were built, the rows those of the result.
    out.cage = std::move(made.control);
    const std::vector<std::uint32_t> rows_of = out.cage.region;
    const std::vector<NodeId> source = std::exchange(out.cage.region_node, wrapped.source);
    for (std::uint32_t& r : out.cage.region) r = source[r].index();
    ConvolutionField field = stages.run("weights", 0.2f, [&] {
        return surface_field(wrapped.skeleton(), options, constraints, extras.weights, ctx);
    });
    const int levels = options.levels - 1;
    const Refined refined = CageRefiner(out, levels, field, wrapped, options, ctx, stages).run();
    out.cage.region = rows_of;
    out.cage.region_node = composed(source, wrapped.source);
    const bool is_coarser = is_coarsened(with) && levels > 0;
    if (extras.rows != nullptr && !is_coarser) *extras.rows = QuadRows{out.mesh, made.tubes, levels};
    const auto wrapping = compress_rows<NodeId>(wrapped.tube.size(), [&](const auto& put) {
        for (std::size_t n = 0; n < wrapped.tube.size(); ++n) {
            if (!wrapped.tube[n]) continue;
            for (const NodeId t : made.wrapping[wrapped.tube[n].index()]) put(n, t);
        }
    });
    const TubeMap map{made.tubes, wrapped.skeleton(), out.cage.region_node, wrapping, made.sides};
    if (is_coarser) {
        remesh_and_coarsen(out, map, refined, with, ctx, stages);
    } else {
        remesh(out, map, levels, with, ctx, stages, nullptr);
    }
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
