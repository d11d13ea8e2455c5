#include "coppice/extract/mesh/from_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/mesh/contraction_internal.h"
#include "coppice/extract/mesh/distance_internal.h"
#include "coppice/extract/mesh/ring_tree_internal.h"
#include "coppice/extract/stage_internal.h"
#include "coppice/extract/tree/draft_edit_internal.h"
#include "coppice/extract/tree/simplify_internal.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr int kFirstFit = 10, kLastFit = 10;   // iterations
constexpr double kWide = 0.3, kNarrow = 0.15;  // [radius] of the robust weight: first the shape, then the fit

/// Runs the stages, and keeps their times.
class Extraction {
  public:
    Extraction(const FromMeshOptions& options, const Context& ctx) : options_(options), ctx_(ctx) {}
    FromMeshResult run(const PolygonMesh& mesh);

  private:
    /// Runs work(context), which takes the whole work up to the fraction `done`.
    template <class Work>
    void stage(std::string_view name, float done, const Work& work) {
        ctx_.throw_if_cancelled();
        const auto start = std::chrono::steady_clock::now();
        work(stage_context(ctx_, done_, done));
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        out_.stages.emplace_back(name, took.count());
        ctx_.report(done_ = done);
    }
    void clean(const PolygonMesh& mesh);
    void draft_from_rings();
    void draft_from_contraction(const Context& ctx);
    void assign_rest();
    void fit(int iterations, double robust, const Context& ctx);
    void finish();
    ExtractReport& report() { return out_.report; }

    const FromMeshOptions& options_;
    const Context& ctx_;
    FromMeshResult out_{{Skeleton({NodeId()}, {Vec3()}, {1.0f}), {}, {}}, {}, {}};
    float done_ = 0;
    Surface surface_;
    Vec3d origin_;
    std::vector<Vec3> normals_;
    DraftTree tree_;
    FitSamples samples_;
};

void Extraction::clean(const PolygonMesh& mesh) {
    CleanMeshResult cleaned = clean_mesh(mesh, options_.clean, ctx_);
    out_.repairs = cleaned.repairs;
    origin_ = cleaned.mesh.origin;
    surface_.positions = std::move(cleaned.mesh.positions);
    surface_.triangles.assign(cleaned.mesh.triangles.begin(), cleaned.mesh.triangles.end());
    connect(surface_);
    normals_ = vertex_normals(surface_, ctx_);
    samples_.positions = surface_.positions;
    samples_.normals = normals_;
    samples_.node.assign(surface_.size(), kNone);
    report().samples = surface_.size();
    report().components = surface_.component_count;
}

/// Where distances start, per piece: at the lowest vertex, or the one nearest to the wanted root, with all of
/// the border that it lies on; of an open tube at its wider end, where rings are true sections at once.
struct Sources {
    std::vector<std::uint32_t> vertices;
    std::vector<char> from_border;  // per piece
};
Sources sources_of(const Surface& s, int up, const std::optional<Vec3d>& root) {
    constexpr std::uint32_t kTubeEnds = 2;
    std::vector<std::uint32_t> first(s.component_count, kNone), loop_count(s.component_count, 0);
    const auto key = [&](std::uint32_t v) {
        const Vec3d p(s.positions[v]);
        return root ? length_squared(p - *root) : p[up];
    };
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        std::uint32_t& best = first[s.component[v]];
        if (best == kNone || key(v) < key(best)) best = v;
    }
    const auto loops = border_loops(s);
    std::vector<const std::vector<std::uint32_t>*> loop_of(s.component_count, nullptr);
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
        if (loop_of[c] == nullptr || extent(loop) > extent(*loop_of[c])) loop_of[c] = &loop;
    }
    Sources out{{}, std::vector<char>(s.component_count, 0)};
    for (std::uint32_t c = 0; c < s.component_count; ++c) {
        out.from_border[c] = loop_of[c] != nullptr;
        if (loop_of[c] != nullptr) {
            out.vertices.insert(out.vertices.end(), loop_of[c]->begin(), loop_of[c]->end());
        } else {
            out.vertices.push_back(first[c]);
        }
    }
    return out;
}

void Extraction::draft_from_rings() {
    std::optional<Vec3d> root;
    if (options_.root) root = *options_.root - origin_;
    const Sources sources = sources_of(surface_, static_cast<int>(options_.up), root);
    const std::vector<double> distance = march_distances(surface_, sources.vertices, ctx_);
    const RingForest forest = follow_chains(surface_, distance, sources.from_border, ctx_);
    if (forest.chains.empty())
        throw InvalidInput("no piece of the mesh is long enough to have an axis; a skeleton needs a branch");
    RingTree strung = string_rings(surface_, forest);
    tree_ = std::move(strung.tree);
    report().loops = static_cast<std::uint32_t>(strung.loops.size());
    const auto new_of_old = cut_loops(tree_, strung.loops, options_.keep_loops);
    for (std::uint32_t v = 0; v < surface_.size(); ++v)
        if (forest.claim[v] != kNone) samples_.node[v] = new_of_old[strung.node_of_ring[forest.claim[v]]];
}

void Extraction::draft_from_contraction(const Context& ctx) {
    Contraction contracted = contract(surface_, ctx);
    tree_ = std::move(contracted.tree);
    samples_.node = std::move(contracted.node);
    report().loops = static_cast<std::uint32_t>(contracted.loops.size());
    const auto new_of_old = cut_loops(tree_, contracted.loops, options_.keep_loops);
    for (std::uint32_t& n : samples_.node)
        if (n != kNone) n = new_of_old[n];
}

/// Vertices without a node get that of a neighbour, spreading.
void Extraction::assign_rest() {
    std::vector<std::uint32_t> front;
    for (std::uint32_t v = 0; v < surface_.size(); ++v)
        if (samples_.node[v] != kNone) front.push_back(v);
    for (std::size_t i = 0; i < front.size(); ++i) {
        for (const std::uint32_t h : surface_.outgoing(front[i])) {
            for (const std::uint32_t w : {surface_.to(h), surface_.from(Surface::previous(h))}) {
                if (samples_.node[w] != kNone) continue;
                samples_.node[w] = samples_.node[front[i]];
                front.push_back(w);
            }
        }
    }
}

void Extraction::fit(int iterations, double robust, const Context& ctx) {
    FitOptions options;
    options.iterations = options_.fit ? iterations : 0;
    options.robust = robust;
    fit_capsules(tree_, samples_, options, ctx);
}

/// Roots, order, and what each node rests on.
void Extraction::finish() {
    report().joined = join_trees(tree_, options_.join, ctx_);
    std::optional<Vec3d> root;
    if (options_.root) root = *options_.root - origin_;
    const auto sort_samples = [&](const std::vector<std::uint32_t>& new_of_old) {
        for (std::uint32_t& n : samples_.node)
            if (n != kNone) n = new_of_old[n];
    };
    sort_samples(sort_parents_first(tree_));
    choose_roots(tree_, static_cast<int>(options_.up), root);
    sort_samples(sort_parents_first(tree_));
    fit(0, kNarrow, ctx_);
    out_.skeleton = to_skeleton(tree_, origin_);
    out_.confidence = rate_nodes(tree_, samples_, report().residual, ctx_);
    report().trees = out_.skeleton.tree_count();
}

FromMeshResult Extraction::run(const PolygonMesh& mesh) {
    const bool rings = options_.method == MeshSkeletonMethod::rings;
    // The share of the time that stages take on large meshes; contraction takes nearly all of it.
    const auto done = [&](float by_rings, float by_contraction) { return rings ? by_rings : by_contraction; };
    stage("clean", done(0.18f, 0.01f), [&](const Context&) { clean(mesh); });
    stage("draft", done(0.31f, 0.97f), [&](const Context& ctx) {
        rings ? draft_from_rings() : draft_from_contraction(ctx);
        assign_rest();
        report().repaired_tips = extend_ends(tree_, samples_);
    });
    stage("fit", done(0.55f, 0.98f), [&](const Context& ctx) {
        fit(kFirstFit, kWide, ctx);
        report().pruned_twigs += prune_stubs(tree_, samples_, options_.prune);
    });
    stage("refine", 0.99f, [&](const Context& ctx) {
        simplify(tree_, samples_, options_.tolerance);
        fit(kLastFit, kNarrow, stage_context(ctx, 0, 0.5f));
        simplify(tree_, samples_, options_.tolerance);
        fit(kLastFit, kNarrow, stage_context(ctx, 0.5f, 1));
        extend_ends(tree_, samples_);
    });
    stage("join", 1.0f, [&](const Context&) { finish(); });
    return std::move(out_);
}

}  // namespace

FromMeshResult extract_from_mesh(const PolygonMesh& mesh, const FromMeshOptions& options,
                                 const Context& ctx) {
    check_fields(options, "extract");
    return Extraction(options, ctx).run(mesh);
}

}  // namespace coppice
