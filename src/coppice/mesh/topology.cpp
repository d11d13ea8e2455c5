#include "coppice/mesh/topology.h"

#include <fmt/format.h>

#include <vector>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kTopologyGrain = 1 << 14;

/// Counts the edges of a range and joins the faces at them, and the corners at their ends.
TopologyReport count_edges(const HalfEdges& mesh, IndexRange edges, ConcurrentDisjointSets& faces,
                           ConcurrentDisjointSets& corners) {
    TopologyReport report;
    for (std::size_t i = edges.begin; i < edges.end; ++i) {
        const auto e = static_cast<std::uint32_t>(i);
        const auto halves = mesh.halves(e);
        const std::uint32_t a = halves[0];
        report.open_edges += halves.size() == 1;
        report.non_manifold_edges += halves.size() > 2;
        report.misoriented_edges += halves.size() == 2 && mesh.twin(a) == kNoIndex;
        if (mesh.origin(a) == mesh.target(a)) corners.join(a, mesh.next(a));
        for (const std::uint32_t b : halves.subspan(1)) {
            const bool same_way = mesh.origin(a) == mesh.origin(b);
            faces.join(mesh.face(a), mesh.face(b));
            corners.join(a, same_way ? b : mesh.next(b));
            corners.join(mesh.next(a), same_way ? mesh.next(b) : b);
        }
    }
    return report;
}

TopologyReport sum(TopologyReport a, const TopologyReport& b) {
    a.open_edges += b.open_edges;
    a.non_manifold_edges += b.non_manifold_edges;
    a.misoriented_edges += b.misoriented_edges;
    return a;
}

/// Counts the vertices; corners at a vertex are of one fan if edges connect them.
void count_vertices(const HalfEdges& mesh, ConcurrentDisjointSets& corners, TopologyReport& report) {
    struct Vertex {
        std::uint32_t faces = 0, fans = 0;
    };
    std::vector<Vertex> vertices(mesh.vertex_count());
    for (std::uint32_t h = 0; h < mesh.size(); ++h) {
        Vertex& v = vertices[mesh.origin(h)];
        ++v.faces;
        v.fans += corners.find(h) == h;
    }
    for (const Vertex& v : vertices) {
        report.vertices += v.faces > 0;
        report.irregular_vertices += v.faces > 0 && v.faces != 4;
        report.non_manifold_vertices += v.fans > 1;
    }
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

TopologyReport topology(const HalfEdges& mesh, const Context& ctx) {
    ConcurrentDisjointSets faces(mesh.face_count()), corners(mesh.size());
    auto report = parallel_reduce(
        ctx, mesh.edge_count(), kTopologyGrain, TopologyReport{},
        [&](IndexRange range) { return count_edges(mesh, range, faces, corners); }, sum);
    count_vertices(mesh, corners, report);
    report.edges = mesh.edge_count();
    report.faces = mesh.face_count();
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        report.quads += mesh.first(f + 1) - mesh.first(f) == 4;
    report.components = faces.set_count();
    report.euler =
        static_cast<std::int64_t>(report.vertices + report.faces) - static_cast<std::int64_t>(report.edges);
    return report;
}

TopologyReport topology(const PolygonMesh& mesh, const Context& ctx) {
    return topology(HalfEdges(mesh, ctx), ctx);
}

TopologyReport topology(const QuadMesh& mesh, const Context& ctx) {
    return topology(HalfEdges(mesh.quads, static_cast<std::uint32_t>(mesh.positions.size()), ctx), ctx);
}

}  // namespace coppice
