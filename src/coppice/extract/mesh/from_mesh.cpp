#include "coppice/extract/mesh/from_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/extract/mesh/contraction_internal.h"
#include "coppice/extract/mesh/distance_internal.h"
#include "coppice/extract/mesh/ring_tree_internal.h"
#include "coppice/extract/tree/simplify_internal.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr int kFirstFit = 10, kLastFit = 10;  // iterations
constexpr float kMarchShare = 0.3f;  // share of the progress of `build_from_rings` used by fast marching
constexpr double kWide = 0.3;
constexpr double kNarrow = 0.15;  // [radius] scale of the robust weight in the first and in the last fit

/// Intermediate state of the extraction: a mesh and its initial tree.
struct MeshTree {
    Surface surface;
    Vec3d origin;
    std::vector<Vec3> normals;
    InitialTree tree;
    FitSamples samples = {};
};

/// Records the durations of the stages and reports progress.
class Stages {
  public:
    Stages(std::vector<std::pair<std::string_view, double>>& times, const Context& ctx)
        : times_(times), ctx_(ctx) {}

    /// Runs work(context); its end corresponds to the progress `done`.
    template <class Work>
    void run(std::string_view name, float done, const Work& work) {
        ctx_.throw_if_cancelled();
        const auto start = std::chrono::steady_clock::now();
        work(narrow_progress(ctx_, done_, done));
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        times_.emplace_back(name, took.count());
        ctx_.report(done_ = done);
    }

  private:
    std::vector<std::pair<std::string_view, double>>& times_;
    const Context& ctx_;
    float done_ = 0;
};

/// Cleans the mesh and makes every vertex a sample; reports the repairs.
void clean(MeshTree& mesh_tree, const PolygonMesh& mesh, const CleanMeshOptions& options, FromMeshResult& out,
           const Context& ctx) {
    CleanMeshResult cleaned = clean_mesh(mesh, options, ctx);
    out.repairs = cleaned.repairs;
    mesh_tree.origin = cleaned.mesh.origin;
    mesh_tree.surface.positions = std::move(cleaned.mesh.positions);
    mesh_tree.surface.triangles.assign(cleaned.mesh.triangles.begin(), cleaned.mesh.triangles.end());
    connect(mesh_tree.surface, ctx);
    mesh_tree.normals = vertex_normals(mesh_tree.surface, ctx);
    mesh_tree.samples.positions = mesh_tree.surface.positions;
    mesh_tree.samples.normals = mesh_tree.normals;
    mesh_tree.samples.node.assign(mesh_tree.surface.size(), kNoIndex);
    out.report.samples = mesh_tree.surface.size();
    out.report.components = mesh_tree.surface.component_count;
}

/// Sources of the distances per component: the lowest vertex, or the one closest to the specified root, with
/// its complete border loop if it has one; of an open tube, the border of the wider end, where rings are
/// cross-sections from the start.
struct Sources {
    std::vector<std::uint32_t> vertices;
    std::vector<char> from_border;  // per component
};
Sources find_sources(const Surface& s, int up, const std::optional<Vec3d>& root) {
    constexpr std::uint32_t kTubeEnds = 2;
    std::vector<std::uint32_t> first(s.component_count, kNoIndex), loop_count(s.component_count, 0);
    const auto key = [&](std::uint32_t v) {
        const Vec3d p(s.positions[v]);
        return root ? length_squared(p - *root) : p[up];
    };
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        std::uint32_t& best = first[s.component[v]];
        if (best == kNoIndex || key(v) < key(best)) best = v;
    }
    const auto loops = border_loops(s);
    std::vector<const std::vector<std::uint32_t>*> component_loop(s.component_count, nullptr);
    for (const auto& loop : loops) ++loop_count[s.component[loop[0]]];
    const auto extent = [&](const std::vector<std::uint32_t>& loop) {
        Box3 box;
        for (const std::uint32_t v : loop) box.extend(s.positions[v]);
        return box.diagonal();
    };
    for (const auto& loop : loops) {
        const std::uint32_t c = s.component[loop[0]];
        const bool holds_first = std::find(loop.begin(), loop.end(), first[c]) != loop.end();
        if (!holds_first && loop_count[c] > kTubeEnds) continue;
        if (component_loop[c] == nullptr || extent(loop) > extent(*component_loop[c]))
            component_loop[c] = &loop;
    }
    Sources out{{}, std::vector<char>(s.component_count, 0)};
    for (std::uint32_t c = 0; c < s.component_count; ++c) {
        out.from_border[c] = component_loop[c] != nullptr;
        if (component_loop[c] != nullptr) {
            out.vertices.insert(out.vertices.end(), component_loop[c]->begin(), component_loop[c]->end());
        } else {
            out.vertices.push_back(first[c]);
        }
    }
    return out;
}

/// Returns the root specified by the user, in the coordinates of the initial tree.
std::optional<Vec3d> wanted_root(const FromMeshOptions& options, Vec3d origin) {
    if (!options.root) return {};
    return *options.root - origin;
}

/// Maps the node indices of the samples to the new ones.
void renumber(FitSamples& samples, std::span<const std::uint32_t> new_of_old) {
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = new_of_old[n];
}

/// Fills the tree and the nodes of the samples from rings; returns the number of loops.
std::size_t build_from_rings(MeshTree& mesh_tree, const FromMeshOptions& options, const Context& ctx) {
    const Surface& s = mesh_tree.surface;
    const Sources sources =
        find_sources(s, static_cast<int>(options.up), wanted_root(options, mesh_tree.origin));
    const std::vector<double> distance = march_distances(s, sources.vertices, ctx);
    const RingForest forest =
        follow_chains(s, distance, sources.from_border, narrow_progress(ctx, kMarchShare, 1));
    if (forest.chains.empty())
        throw InvalidInput(
            "no component of the mesh is long enough to have an axis; a skeleton needs a branch");
    RingTree rings = connect_rings(s, forest);
    mesh_tree.tree = std::move(rings.tree);
    for (std::uint32_t v = 0; v < s.size(); ++v)
        if (forest.claim[v] != kNoIndex) mesh_tree.samples.node[v] = rings.node_of_ring[forest.claim[v]];
    renumber(mesh_tree.samples, cut_loops(mesh_tree.tree, rings.loops, options.keep_loops));
    return rings.loops.size();
}

/// Fills the tree and the nodes of the samples by contraction; returns the number of loops.
std::size_t build_from_contraction(MeshTree& mesh_tree, const FromMeshOptions& options, const Context& ctx) {
    Contraction contracted = contract(mesh_tree.surface, options.thickness, ctx);
    mesh_tree.tree = std::move(contracted.tree);
    mesh_tree.samples.node = std::move(contracted.node);
    renumber(mesh_tree.samples, cut_loops(mesh_tree.tree, contracted.loops, options.keep_loops));
    return contracted.loops.size();
}

/// Assigns each vertex without a node that of a neighbour, breadth first.
void assign_rest(const Surface& surface, std::span<std::uint32_t> node) {
    std::vector<std::uint32_t> front;
    for (std::uint32_t v = 0; v < surface.size(); ++v)
        if (node[v] != kNoIndex) front.push_back(v);
    for (std::size_t i = 0; i < front.size(); ++i) {
        for (const std::uint32_t h : surface.outgoing(front[i])) {
            for (const std::uint32_t w : {surface.to(h), surface.from(previous_half_edge<3>(h))}) {
                if (node[w] != kNoIndex) continue;
                node[w] = node[front[i]];
                front.push_back(w);
            }
        }
    }
}

/// Attaches components and chooses roots; returns the number of attached components.
std::uint32_t join_and_root(MeshTree& mesh_tree, const FromMeshOptions& options, const Context& ctx) {
    const std::uint32_t joined = join_trees(mesh_tree.tree, options.join, ctx);
    renumber(mesh_tree.samples, sort_parents_first(mesh_tree.tree));
    choose_roots(mesh_tree.tree, static_cast<int>(options.up), wanted_root(options, mesh_tree.origin));
    renumber(mesh_tree.samples, sort_parents_first(mesh_tree.tree));
    return joined;
}

}  // namespace

FromMeshResult extract_from_mesh(const PolygonMesh& mesh, const FromMeshOptions& options,
                                 const Context& ctx) {
    check_fields(options, "extract");
    FromMeshResult out{{Skeleton({NodeId()}, {Vec3()}, {1.0f}), {}, {}}, {}, {}, {}, {}};
    MeshTree mesh_tree;
    InitialTree& tree = mesh_tree.tree;
    FitSamples& samples = mesh_tree.samples;
    const bool rings = options.method == MeshSkeletonMethod::rings;
    // Progress at the end of each stage on large meshes; contraction uses nearly all of the time.
    const auto done = [&](float by_rings, float by_contraction) { return rings ? by_rings : by_contraction; };
    const auto fit = [&](int iterations, double robust, const Context& stage) {
        fit_capsules(tree, samples, {.iterations = options.fit ? iterations : 0, .robust = robust}, stage);
    };
    Stages stages(out.stages, ctx);
    stages.run("clean", done(0.18f, 0.01f),
               [&](const Context& stage) { clean(mesh_tree, mesh, options.clean, out, stage); });
    stages.run("draft", done(0.31f, 0.97f), [&](const Context& stage) {
        out.report.loops =
            static_cast<std::uint32_t>(rings ? build_from_rings(mesh_tree, options, stage)
                                             : build_from_contraction(mesh_tree, options, stage));
        assign_rest(mesh_tree.surface, samples.node);
        out.report.repaired_tips = extend_ends(tree, samples);
    });
    stages.run("fit", done(0.55f, 0.98f), [&](const Context& stage) {
        fit(kFirstFit, kWide, stage);
        out.report.pruned_twigs += prune_stubs(tree, samples, options.prune);
    });
    stages.run("refine", 0.99f, [&](const Context& stage) {
        simplify(tree, samples, options.tolerance);
        fit(kLastFit, kNarrow, narrow_progress(stage, 0, 0.5f));
        simplify(tree, samples, options.tolerance);
        fit(kLastFit, kNarrow, narrow_progress(stage, 0.5f, 1));
        extend_ends(tree, samples);
    });
    stages.run("join", 1.0f, [&](const Context& stage) {
        out.report.joined = join_and_root(mesh_tree, options, stage);
        fit(0, kNarrow, stage);  // only reassigns the samples to segments
        out.skeleton = to_skeleton(tree, mesh_tree.origin);
        out.confidence = rate_nodes(tree, samples, out.report.residual, stage);
        out.report.trees = out.skeleton.tree_count();
        assign_rest(mesh_tree.surface, samples.node);
        out.vertices = {std::move(mesh_tree.surface.positions), mesh_tree.origin};
        out.nodes = std::move(samples.node);
    });
    return out;
}

void list_fields(FromMeshOptions& o, FieldList& list) {
    list.add(Field{"method", "Method that computes the axes from the mesh."}, o.method);
    list.add(Field{"thickness",
                   "Statistic of contraction that computes the radius of a node from the distances of the "
                   "vertices merged into it; initial value of the fit."},
             o.thickness);
    list.add(Field{"fit", "Fit the segments to the vertices by least squares."}, o.fit);
    list.add(common_field("prune", "Minimum height of a branch above its fork; shorter ends are removed.",
                          Unit::radius, 0, 10),
             o.prune);
    list.add(
        Field{"join",
              "Maximum distance of an end from the axis of another component for attaching it; 0 disables "
              "this.",
              Unit::radius, 0, 10},
        o.join);
    list.add(Field{"tolerance", "Maximum change of the surface by removing nodes.", Unit::radius, 0, 1},
             o.tolerance);
    list.add(Field{"keep_loops", "Extend an end that was cut off a loop to the place of the cut."},
             o.keep_loops);
    list.add(Field{"up", "Axis of the mesh that points up; roots are the lowest ends."}, o.up);
    list.add(common_field(
                 "wood",
                 "Read only the faces of groups or materials with this text in their name; may be repeated."),
             o.clean.wood);
    list.add(Field{"cards", "Remove flat components, which are usually leaves."}, o.clean.cards);
    list.add(
        Field{"weld", "Maximum distance of vertices that are merged, as a share of the size of the mesh.",
              Unit::none, 0, 0.01},
        o.clean.weld);
    list.add(Field{"root", "Point closest to the root of the tree; by default the root is the lowest end.",
                   Unit::metre},
             o.root);
}

}  // namespace coppice
