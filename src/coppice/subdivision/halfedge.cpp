#include "coppice/subdivision/halfedge_internal.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::int32_t kBoundary = HalfedgeMesh::kBoundary;

std::int32_t next(std::int32_t h) { return (h & ~3) | ((h + 1) & 3); }
std::int32_t prev(std::int32_t h) { return (h & ~3) | ((h + 3) & 3); }

void refine_topology(const HalfedgeMesh& in, HalfedgeMesh& out) {
    const auto halves = static_cast<std::int32_t>(in.twin.size());
    const std::int32_t faces = in.vertex_count();
    const std::int32_t edges = faces + in.face_count();
    out.twin.resize(4 * in.twin.size());
    out.edge.resize(4 * in.twin.size());
    out.vertex.resize(4 * in.twin.size());
    out.edge_count = 2 * in.edge_count + halves;
    for (std::int32_t h = 0; h < halves; ++h) {
        const std::int32_t before = prev(h);
        const std::int32_t twin = in.twin[h];
        const std::int32_t twin_before = in.twin[before];
        std::int32_t* t = &out.twin[4 * h];
        t[0] = twin == kBoundary ? kBoundary : 4 * next(twin) + 3;
        t[1] = 4 * next(h) + 2;
        t[2] = 4 * before + 1;
        t[3] = twin_before == kBoundary ? kBoundary : 4 * twin_before;
        std::int32_t* e = &out.edge[4 * h];
        e[0] = 2 * in.edge[h] + (h > twin ? 0 : 1);
        e[1] = 2 * in.edge_count + h;
        e[2] = 2 * in.edge_count + before;
        e[3] = 2 * in.edge[before] + (before > twin_before ? 1 : 0);
        std::int32_t* v = &out.vertex[4 * h];
        v[0] = in.vertex[h];
        v[1] = edges + in.edge[h];
        v[2] = faces + (h >> 2);
        v[3] = edges + in.edge[before];
    }
}

void refine_face_points(const HalfedgeMesh& in, std::span<Vec3d> face_points) {
    for (std::size_t h = 0; h < in.vertex.size(); ++h) face_points[h / 4] += 0.25 * in.points[in.vertex[h]];
}

void refine_edge_points(const HalfedgeMesh& in, std::span<const Vec3d> face_points,
                        std::span<Vec3d> edge_points) {
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(in.twin.size()); ++h) {
        const Vec3d start = in.points[in.vertex[h]];
        edge_points[in.edge[h]] += in.twin[h] == kBoundary ? 0.5 * (start + in.points[in.vertex[next(h)]])
                                                           : 0.25 * (start + face_points[h / 4]);
    }
}

// Valence n: (n - 3) / n v + 1 / n (mean of face points) + 2 / n (mean of edge midpoints), or 3/4 v + 1/8 of
// each neighbour along the boundary.
void refine_vertex_points(const HalfedgeMesh& in, std::span<const Vec3d> face_points,
                          std::span<Vec3d> points) {
    struct Fan {
        int faces = 0;
        int boundary_edges = 0;
        Vec3d faces_sum, midpoints_sum, boundary_sum;
    };
    std::vector<Fan> fans(in.points.size());
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(in.twin.size()); ++h) {
        const std::int32_t v = in.vertex[h];
        const std::int32_t w = in.vertex[next(h)];
        fans[v].faces += 1;
        fans[v].faces_sum += face_points[h / 4];
        fans[v].midpoints_sum += 0.5 * (in.points[v] + in.points[w]);
        if (in.twin[h] != kBoundary) continue;
        fans[v].boundary_edges += 1;
        fans[v].boundary_sum += in.points[w];
        fans[w].boundary_edges += 1;
        fans[w].boundary_sum += in.points[v];
    }
    for (std::size_t v = 0; v < fans.size(); ++v) {
        const Fan& fan = fans[v];
        const double n = fan.faces;
        if (fan.boundary_edges > 0) {
            points[v] = 0.75 * in.points[v] + fan.boundary_sum * (0.25 / fan.boundary_edges);
        } else if (fan.faces > 0) {
            points[v] =
                (n - 3) / n * in.points[v] + (fan.faces_sum + 2.0 * fan.midpoints_sum) * (1 / (n * n));
        } else {
            points[v] = in.points[v];
        }
    }
}

}  // namespace

HalfedgeMesh build_halfedges(std::span<const Vec3> points, std::span<const Quad> quads) {
    HalfedgeMesh mesh;
    mesh.points.reserve(points.size());
    for (const Vec3& p : points) mesh.points.emplace_back(p);
    mesh.twin.assign(4 * quads.size(), kBoundary);
    mesh.edge.resize(mesh.twin.size());
    for (const Quad& q : quads) mesh.vertex.insert(mesh.vertex.end(), q.begin(), q.end());
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> by_ends;
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.twin.size()); ++h) {
        const std::int32_t from = mesh.vertex[h];
        const std::int32_t to = mesh.vertex[next(h)];
        if (!by_ends.emplace(std::pair{from, to}, h).second) {
            throw InvalidInput(
                fmt::format("two quads have the edge from vertex {} to vertex {} in the same direction, "
                            "reverse one of them",
                            from, to));
        }
        const auto other = by_ends.find({to, from});
        if (other == by_ends.end()) {
            mesh.edge[h] = mesh.edge_count++;
        } else {
            mesh.edge[h] = mesh.edge[other->second];
            mesh.twin[h] = other->second;
            mesh.twin[other->second] = h;
        }
    }
    return mesh;
}

HalfedgeMesh refine_halfedges(const HalfedgeMesh& mesh) {
    HalfedgeMesh out;
    refine_topology(mesh, out);
    const std::size_t vertices = mesh.points.size();
    const auto faces = static_cast<std::size_t>(mesh.face_count());
    out.points.resize(vertices + faces + static_cast<std::size_t>(mesh.edge_count));
    const std::span<Vec3d> points(out.points);
    refine_face_points(mesh, points.subspan(vertices, faces));
    refine_edge_points(mesh, points.subspan(vertices, faces), points.subspan(vertices + faces));
    refine_vertex_points(mesh, points.subspan(vertices, faces), points.first(vertices));
    return out;
}

QuadMesh to_quads(const HalfedgeMesh& mesh) {
    QuadMesh out;
    out.positions.reserve(mesh.points.size());
    for (const Vec3d& p : mesh.points) out.positions.emplace_back(p);
    out.quads.resize(static_cast<std::size_t>(mesh.face_count()));
    for (std::size_t h = 0; h < mesh.vertex.size(); ++h) {
        out.quads[h / 4][h % 4] = static_cast<std::uint32_t>(mesh.vertex[h]);
    }
    return out;
}

}  // namespace coppice
