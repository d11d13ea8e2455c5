#include "coppice/pipeline/coarsen/coarsen_quads_internal.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "coppice/measure/axes.h"
#include "coppice/measure/cone_union.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/coarsen/node_levels_internal.h"
#include "coppice/pipeline/coarsen/selection_internal.h"
#include "coppice/pipeline/end_shapes_internal.h"
#include "coppice/pipeline/quads/blunt_tips_internal.h"
#include "coppice/pipeline/repair/crossings_internal.h"

namespace coppice::pipeline_internal {
namespace {

class Coarsening {
  public:
    Coarsening(QuadMesh& mesh, const QuadBuild& build, const Context& ctx)
        : mesh_(mesh),
          build_(build),
          ctx_(ctx),
          grid_(mesh, build),
          tube_rows_(grid_.tube_rows()),
          level_(node_levels(grid_, build.options.chord_error)) {}

    CoarsenReport run(CoarseQuads& made) {
        CoarsenReport report{mesh_.quads.size()};
        QuadMesh coarse;
        for (Flags is_new(level_.size(), 1); any(is_new); is_new = raise_faulty(coarse, report))
            coarse = without_crossings(is_new, report);
        mesh_ = std::move(coarse);
        made = std::move(made_);
        return report;
    }

  private:
    using Flags = std::vector<std::uint8_t>;  // per node

    static bool any(const Flags& flags) { return std::ranges::find(flags, 1) != flags.end(); }

    // Returns the surface of the current levels, after raising levels where its quads cross near new nodes.
    QuadMesh without_crossings(Flags is_new, CoarsenReport& report) {
        for (;;) {
            Selection chosen = select_quads(grid_, level_);
            QuadMesh coarse = make_mesh(chosen);
            is_new = raise_bad(coarse, chosen.made.cage_quad, is_new, report);
            if (any(is_new)) continue;
            made_ = std::move(chosen.made);
            return coarse;
        }
    }

    int levels() const { return tube_rows_.levels(); }

    // Remeshed quads follow the kept ones.
    std::span<const Quad> remeshed_quads() const {
        std::size_t made = 0;
        for (const RemeshTrace::RepairPatch& repair_patch : build_.remeshed.repair_patches)
            made += repair_patch.quads;
        return std::span<const Quad>(mesh_.quads).last(made);
    }

    QuadMesh make_mesh(const Selection& chosen) const {
        const std::vector<Vec3> positions = moved_vertices(chosen);
        NumberSet used(positions.size());
        for (const Quad& q : chosen.made.quads) {
            for (const std::uint32_t v : q) used.add(grid_.number(v));
        }
        for (const Quad& q : remeshed_quads()) {
            for (const std::uint32_t v : q) used.add(v);
        }
        used.count();
        QuadMesh out;
        out.origin = mesh_.origin;
        for (const std::uint32_t v : used.ascending()) out.positions.push_back(positions[v]);
        for (const Quad& q : chosen.made.quads) {
            Quad& now = out.quads.emplace_back();
            std::ranges::transform(q, now.begin(),
                                   [&](std::uint32_t v) { return used.rank(grid_.number(v)); });
        }
        for (const Quad& q : remeshed_quads()) {
            Quad& now = out.quads.emplace_back();
            std::ranges::transform(q, now.begin(), [&](std::uint32_t v) { return used.rank(v); });
        }
        return out;
    }

    // Returns all vertices of the mesh, at their positions in polygons of fewer sides.
    std::vector<Vec3> moved_vertices(const Selection& chosen) const {
        std::vector<Vec3> out(mesh_.positions.begin(), mesh_.positions.end());
        for (std::uint32_t v = 0; v < chosen.growth.size(); ++v) {
            if (chosen.growth[v] == 0) continue;
            Vec3& p = out[grid_.number(v)];
            p += (p - grid_.anchor(v)) * chosen.growth[v];
        }
        if (build_.options.control.tips == TipShape::round) {
            shape_blunt_tips(
                build_.cage, tube_rows_.tubes(), [&](NodeId tip) { return level_[tip.index()] == 0; },
                [&](std::uint32_t v) -> Vec3& { return out[grid_.number(v)]; });
        }
        return out;
    }

    // Raises the level of the nodes at which quads cross or are inverted, if these are near new nodes;
    // returns the raised nodes.
    Flags raise_bad(const QuadMesh& mesh, std::span<const std::uint32_t> cage_quad, const Flags& is_new,
                    CoarsenReport& report) {
        std::vector<std::uint32_t> faces;  // new faces
        for (std::uint32_t q = 0; q < cage_quad.size(); ++q) {
            for_each_node(cage_quad[q], [&](NodeId n) {
                if (is_new[n.index()] != 0 && (faces.empty() || faces.back() != q)) faces.push_back(q);
            });
        }
        Flags is_raised(level_.size(), 0);
        const auto mark = [&](std::uint32_t q) {
            if (q >= cage_quad.size()) return;
            for_each_node(cage_quad[q], [&](NodeId n) { is_raised[n.index()] = 1; });
        };
        for (const std::uint32_t q : faces) {
            if (scaled_jacobian(mesh.quads[q], mesh.positions) <= 0) mark(q);
        }
        for (const FacePair& p : find_crossings(mesh, faces)) {
            mark(p.first);
            mark(p.second);
        }
        raise(is_raised, report);
        return is_raised;
    }

    // Raises the level of the nodes between which an axis is severed or a tip is short; returns them.
    Flags raise_faulty(const QuadMesh& mesh, CoarsenReport& report) {
        if (build_.options.control.base == BaseShape::open) return {};  // a surface with a hole has no inside
        const Skeleton& skeleton = build_.skeleton;
        const EndShape tips = tip_end(build_.options.control);
        const ConeUnion solid(skeleton, mesh.origin, base_end(build_.options.control), tips, ctx_);
        Flags is_raised(level_.size(), 0);
        for (const NodeId n : judge_axes(mesh, skeleton, solid, tips, ctx_).faulty) {
            for (const NodeId tube : build_.wrapping[n.index()]) {
                is_raised[tube_rows_.node(tube, 0).index()] = 1;
                is_raised[tube_rows_.node(tube, 1).index()] = 1;
            }
        }
        raise(is_raised, report);
        return is_raised;
    }

    // Raises the level of some nodes; those at the maximum are removed from the flags.
    void raise(Flags& nodes, CoarsenReport& report) {
        for (std::size_t n = 0; n < level_.size(); ++n) {
            nodes[n] = nodes[n] != 0 && level_[n] < levels() ? 1 : 0;
            level_[n] = static_cast<std::uint8_t>(level_[n] + nodes[n]);
            report.raised += nodes[n];
        }
    }

    // Returns the pairs of faces that cross, of which one is among the given faces, or both are near them.
    std::vector<FacePair> find_crossings(const QuadMesh& mesh, std::span<const std::uint32_t> faces) const {
        const FaceView all(mesh);
        std::vector<Box3> boxes;
        for (const std::uint32_t q : faces) boxes.push_back(all.box(q));
        if (boxes.empty()) return {};
        return crossings_among(all, faces_near(all, boxes, ctx_), kMaxPairs, ctx_).pairs;
    }

    template <class Visit>
    void for_each_node(std::uint32_t f, const Visit& visit) const {
        const ControlMesh& control = build_.cage;
        const NodeId region(control.region[f]);
        if (control.part[f] == TubeFace::fork) {
            visit(region);
            return;
        }
        if (!tube_rows_.tubes().is_root(region)) visit(tube_rows_.tubes().parent(region));
        visit(tube_rows_.end_node(region));
    }

    QuadMesh& mesh_;
    const QuadBuild& build_;
    const Context& ctx_;
    RefinedGrid grid_;
    const TubeRows& tube_rows_;
    std::vector<std::uint8_t> level_;  // per node
    CoarseQuads made_;
};

}  // namespace

CoarsenReport coarsen_quads(QuadMesh& mesh, QuadBuild& build, const Context& ctx) {
    return Coarsening(mesh, build, ctx).run(build.coarse);
}

}  // namespace coppice::pipeline_internal
