#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/io_mesh/write_internal.h"
#include "coppice/mesh/half_edges.h"

namespace coppice::io_internal {
namespace {

// The change of a triangle's texture coordinates from its first corner to the others.
struct TextureSides {
    TextureSides(const SplitMesh& mesh, const Triangle& t) {
        const auto& places = mesh.table.places;
        const TexturePoint a = places[t[0]], b = places[t[1]], c = places[t[2]];
        u1 = double{b.u} - double{a.u};
        v1 = double{b.v} - double{a.v};
        u2 = double{c.u} - double{a.u};
        v2 = double{c.v} - double{a.v};
    }
    // Returns twice the area in the texture, negative if it is mirrored.
    double area() const { return u1 * v2 - u2 * v1; }

    double u1, v1, u2, v2;
};

// Gives each group of corners its own vertex, by adding vertices to a mesh for all groups at a vertex
// except the first.
void divide_vertices(DisjointSets& groups, SplitMesh& mesh) {
    std::vector<std::uint32_t> vertex_of_group(3 * mesh.triangles.size(), kNoIndex);
    std::vector<std::uint8_t> is_taken(mesh.positions.size(), 0);
    for (std::uint32_t corner = 0; corner < vertex_of_group.size(); ++corner) {
        std::uint32_t& vertex = mesh.triangles[corner / 3][corner % 3];
        std::uint32_t& to = vertex_of_group[groups.find(corner)];
        if (to == kNoIndex && is_taken[vertex] == 0) {
            is_taken[vertex] = 1;
            to = vertex;
        } else if (to == kNoIndex) {
            to = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(mesh.positions[vertex]);
            mesh.table.places.push_back(mesh.table.places[vertex]);
            mesh.table.vertex.push_back(mesh.table.vertex[vertex]);
        }
        vertex = to;
    }
}

// Sum over the triangles around a vertex.
struct TangentSum {
    Vec3d direction;
    double sign = 0;
};

// Returns the unit vector along the projection of a vector on the plane of a normal; zero if there is none.
Vec3d project(Vec3d v, Vec3d normal) { return normalized(v - normal * dot(v, normal), Vec3d{}); }

// Adds the direction of u in a triangle, weighted by the angles at its corners.
void add_triangle(const SplitMesh& mesh, std::span<const Vec3> normals, const Triangle& t,
                  std::vector<TangentSum>& sums) {
    const auto side = [&](std::size_t to, std::size_t from) {
        return Vec3d(mesh.positions[t[to]]) - Vec3d(mesh.positions[t[from]]);
    };
    const TextureSides texture(mesh, t);
    const double sign = texture.area() < 0 ? -1 : 1;
    const Vec3d along =
        texture.area() == 0 ? Vec3d{} : (side(1, 0) * texture.v2 - side(2, 0) * texture.v1) * sign;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d normal(normals[t[k]]);
        const Vec3d a = project(side((k + 1) % 3, k), normal), b = project(side((k + 2) % 3, k), normal);
        const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
        sums[t[k]].direction += project(along, normal) * angle;
        sums[t[k]].sign = sign;
    }
}

}  // namespace

void SplitMesh::divide_for_tangents(const Context& ctx) {
    triangles.reserve(view.triangle_count());
    for (std::size_t f = 0; f < view.face_count; ++f) {
        for_each_triangle(view, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            triangles.push_back({a, b, c});
        });
    }
    DisjointSets groups(3 * triangles.size());
    const HalfEdges edges(std::span<const Triangle>(triangles), static_cast<std::uint32_t>(positions.size()),
                          ctx);
    const auto is_mirrored = [&](std::uint32_t half_edge) {
        return TextureSides(*this, triangles[half_edge / 3]).area() < 0;
    };
    const auto corners = [&](std::uint32_t h) {  // at the lower and the higher vertex of the edge
        return edges.is_backward(h) ? std::pair(edges.next(h), h) : std::pair(h, edges.next(h));
    };
    for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
        const auto halves = edges.halves(e);
        const auto [low, high] = corners(halves[0]);
        for (const std::uint32_t h : halves.subspan(1)) {
            if (is_mirrored(h) != is_mirrored(halves[0])) continue;
            groups.join(low, corners(h).first);
            groups.join(high, corners(h).second);
        }
    }
    divide_vertices(groups, *this);
    view.positions = positions;
    view.corners = triangles[0].data();
    view.first = nullptr;
    view.sides = 3;
    view.face_count = triangles.size();
    view.texture = {};
}

std::vector<Tangent> compute_tangents(const SplitMesh& mesh, std::span<const Vec3> normals) {
    std::vector<TangentSum> sums(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) add_triangle(mesh, normals, t, sums);
    std::vector<Tangent> out;
    out.reserve(sums.size());
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const Vec3 direction(normalized(sums[v].direction, Vec3d(perpendicular(normals[v]))));
        out.push_back({direction, static_cast<float>(sums[v].sign)});
    }
    return out;
}

}  // namespace coppice::io_internal
