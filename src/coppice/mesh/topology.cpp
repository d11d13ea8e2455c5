#include "coppice/mesh/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

constexpr std::size_t kTopologyGrain = 1 << 14;

/// Corner of a face with its adjacent vertices in the face.
struct Corner {
    std::uint32_t vertex, next, previous, face;
};

/// End of an edge at a vertex: the vertex at the other end, and the adjacent corner.
struct Spoke {
    std::uint32_t neighbour;
    std::uint32_t corner : 31;
    std::uint32_t outgoing : 1;
};

Buffer<Corner> corners_by_vertex(const PolygonMesh& mesh, const Context& ctx) {
    Buffer<Corner> corners(mesh.corners.size());
    parallel_for(ctx, mesh.face_count(), kTopologyGrain, [&](std::size_t f) {
        const auto id = static_cast<std::uint32_t>(f);
        const auto c = mesh.face(id);
        for (std::size_t k = 0, n = c.size(); k < n; ++k) {
            corners[mesh.first[f] + k] = {c[k], c[k + 1 < n ? k + 1 : 0], c[k > 0 ? k - 1 : n - 1], id};
        }
    });
    radix_sort(ctx, corners, std::bit_width(mesh.positions.size()), [](const Corner& c) { return c.vertex; });
    return corners;
}

/// Analyses one vertex after another; reuses its buffers.
class FanJudge {
  public:
    FanJudge(ConcurrentDisjointSets& parts, TopologyReport& report) : parts_(parts), report_(report) {}

    void judge(std::span<const Corner> fan) {
        ++report_.vertices;
        report_.irregular_vertices += fan.size() != 4;
        gather(fan);
        std::uint32_t classes = static_cast<std::uint32_t>(fan.size());
        for (std::size_t i = 0; i < spokes_.size();) {
            std::size_t end = i;
            while (end < spokes_.size() && spokes_[end].neighbour == spokes_[i].neighbour) ++end;
            for (std::size_t k = i + 1; k < end; ++k)
                classes -= fan_.join(spokes_[i].corner, spokes_[k].corner);
            judge_edge(fan, {spokes_.data() + i, end - i});
            i = end;
        }
        report_.non_manifold_vertices += classes > 1;
    }

  private:
    void gather(std::span<const Corner> fan) {
        spokes_.clear();
        fan_.reset(fan.size());
        for (std::uint32_t i = 0; i < fan.size(); ++i) {
            spokes_.push_back({fan[i].next, i, 1});
            spokes_.push_back({fan[i].previous, i, 0});
        }
        std::sort(spokes_.begin(), spokes_.end(),
                  [](const Spoke& a, const Spoke& b) { return a.neighbour < b.neighbour; });
    }

    /// Counts the edge only at its vertex with the smaller index.
    void judge_edge(std::span<const Corner> fan, std::span<const Spoke> edge) {
        const std::uint32_t vertex = fan[0].vertex;
        if (edge[0].neighbour < vertex) return;
        std::size_t uses = edge.size(), outgoing = 0;
        for (const Spoke& s : edge) outgoing += s.outgoing;
        if (edge[0].neighbour == vertex)
            uses = outgoing;  // both ends of an edge from a vertex to itself are at this vertex
        ++report_.edges;
        report_.open_edges += uses == 1;
        report_.non_manifold_edges += uses > 2;
        report_.misoriented_edges += uses == 2 && outgoing != 1;
        for (std::size_t k = 1; k < edge.size(); ++k)
            parts_.join(fan[edge[0].corner].face, fan[edge[k].corner].face);
    }

    ConcurrentDisjointSets& parts_;
    TopologyReport& report_;
    std::vector<Spoke> spokes_;
    DisjointSets fan_;  // corners that share an edge
};

TopologyReport sum(TopologyReport a, const TopologyReport& b) {
    a.vertices += b.vertices;
    a.edges += b.edges;
    a.open_edges += b.open_edges;
    a.non_manifold_edges += b.non_manifold_edges;
    a.misoriented_edges += b.misoriented_edges;
    a.non_manifold_vertices += b.non_manifold_vertices;
    a.irregular_vertices += b.irregular_vertices;
    return a;
}

}  // namespace

void validate(const PolygonMesh& mesh) {
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if (!is_finite(mesh.positions[v])) {
            throw InvalidInput(
                fmt::format("vertex {} of the mesh has a coordinate that is not a finite number", v));
        }
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        if (face.size() < 3)
            throw InvalidInput(fmt::format("face {} of the mesh has fewer than three corners", f));
        for (const std::uint32_t v : face) {
            if (v < mesh.positions.size()) continue;
            throw InvalidInput(
                fmt::format("face {} of the mesh refers to vertex {} of {}", f, v, mesh.positions.size()));
        }
    }
}

TopologyReport topology(const PolygonMesh& mesh, const Context& ctx) {
    const Buffer<Corner> corners = corners_by_vertex(mesh, ctx);
    ConcurrentDisjointSets parts(mesh.face_count());
    // A range processes the fans that begin in it, including those that end in the next one.
    const auto judge_range = [&](IndexRange range) {
        TopologyReport report;
        FanJudge judge(parts, report);
        std::size_t i = range.begin;
        while (i > 0 && i < range.end && corners[i].vertex == corners[i - 1].vertex) ++i;
        while (i < range.end) {
            std::size_t end = i;
            while (end < corners.size() && corners[end].vertex == corners[i].vertex) ++end;
            judge.judge({corners.data() + i, end - i});
            i = end;
        }
        return report;
    };
    auto report = parallel_reduce(ctx, corners.size(), kTopologyGrain, TopologyReport{}, judge_range, sum);
    report.faces = mesh.face_count();
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) report.quads += mesh.face(f).size() == 4;
    report.components = parts.set_count();
    report.euler =
        static_cast<std::int64_t>(report.vertices + report.faces) - static_cast<std::int64_t>(report.edges);
    return report;
}

TopologyReport topology(const QuadMesh& mesh, const Context& ctx) { return topology(to_polygons(mesh), ctx); }

}  // namespace coppice
