#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/io_mesh/write_internal.h"
#include "coppice/mesh/half_edges.h"

namespace coppice::io_internal {
namespace {

constexpr std::size_t kGrain = 1024;

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

// Numbers the groups of the corners at a vertex. Corners are in one group if their triangles are connected by
// edges at the vertex, and are all mirrored in the texture or all not.
class CornerGroups {
  public:
    CornerGroups(std::span<const Triangle> triangles, std::span<const std::uint8_t> is_mirrored)
        : triangles_(triangles), is_mirrored_(is_mirrored) {}

    // Sets the group of each corner at a vertex, in the order of their first corners; returns their number.
    std::uint32_t set(std::span<const std::uint32_t> corners, std::span<std::uint32_t> group_of_corner) {
        sides_.clear();
        sets_.reset(corners.size());
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
            const std::uint32_t t = corners[i] / 3, k = corners[i] % 3;
            for (const std::uint32_t other : {(k + 1) % 3, (k + 2) % 3})
                sides_.emplace_back(2 * std::uint64_t{triangles_[t][other]} + is_mirrored_[t], i);
        }
        std::ranges::sort(sides_);
        for (std::size_t i = 1; i < sides_.size(); ++i) {
            if (sides_[i].first == sides_[i - 1].first) sets_.join(sides_[i].second, sides_[i - 1].second);
        }
        std::uint32_t count = 0;
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
            const std::uint32_t first = sets_.find(i);
            group_of_corner[corners[i]] = first == i ? count++ : group_of_corner[corners[first]];
        }
        return count;
    }

  private:
    std::span<const Triangle> triangles_;
    std::span<const std::uint8_t> is_mirrored_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sides_;  // the edge and the corner
    DisjointSets sets_;
};

// Returns the faces as triangles.
Buffer<Triangle> list_triangles(const MeshView& view, const Context& ctx) {
    Buffer<Triangle> out(view.triangle_count());
    parallel_for(ctx, view.face_count, kGrain, [&](std::size_t f) {
        std::size_t next = view.first_corner(f) - 2 * f;
        for_each_triangle(view, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            out[next++] = {a, b, c};
        });
    });
    return out;
}

// Gives each group of corners its own vertex, by adding vertices for all groups at a vertex except the first.
void divide_vertices(SplitMesh& mesh, const Context& ctx) {
    std::vector<std::uint8_t> is_mirrored(mesh.triangles.size());
    parallel_for(ctx, is_mirrored.size(), kGrain, [&](std::size_t t) {
        is_mirrored[t] = TextureSides(mesh, mesh.triangles[t]).area() < 0 ? 1 : 0;
    });
    const std::size_t count = mesh.positions.size();
    std::vector<std::uint32_t> group(3 * mesh.triangles.size()), added(count, 0);
    parallel_for_ranges(ctx, count, kGrain, [&](IndexRange vertices) {
        CornerGroups groups(mesh.triangles, is_mirrored);
        for (std::size_t v = vertices.begin; v < vertices.end; ++v) {
            if (const auto corners = mesh.corners[v]; !corners.empty())
                added[v] = groups.set(corners, group) - 1;
        }
    });
    for (std::size_t v = 0; v < count; ++v) {
        if (added[v] == 0) continue;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const std::uint32_t corner : mesh.corners[v]) {
            if (group[corner] > 0) mesh.triangles[corner / 3][corner % 3] = first + group[corner] - 1;
        }
        mesh.positions.insert(mesh.positions.end(), added[v], mesh.positions[v]);
        mesh.table.places.insert(mesh.table.places.end(), added[v], mesh.table.places[v]);
        if (!mesh.table.blends.empty())
            mesh.table.blends.insert(mesh.table.blends.end(), added[v], mesh.table.blends[v]);
        mesh.table.vertex.insert(mesh.table.vertex.end(), added[v], mesh.table.vertex[v]);
    }
}

// Sum over the triangles around a vertex.
struct TangentSum {
    Vec3d direction;
    double sign = 0;
};

// Returns the unit vector along the projection of a vector on the plane of a normal; zero if there is none.
Vec3d project(Vec3d v, Vec3d normal) { return normalized(v - normal * dot(v, normal), Vec3d{}); }

// Returns an angle by its cosine, with an error below 1e-4: formula 4.4.45 of [Abramowitz1964].
double compute_angle(double cosine) {
    const double x = std::min(std::abs(cosine), 1.0);
    const double angle = std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
    return cosine < 0 ? std::numbers::pi - angle : angle;
}

// Adds the direction of u at a corner of a triangle, weighted by the angle there.
void add_corner(const SplitMesh& mesh, std::uint32_t corner, Vec3d normal, TangentSum& sum) {
    const Triangle& t = mesh.triangles[corner / 3];
    const std::uint32_t k = corner % 3;
    const auto side = [&](std::uint32_t to, std::uint32_t from) {
        return Vec3d(mesh.positions[t[to]]) - Vec3d(mesh.positions[t[from]]);
    };
    const TextureSides texture(mesh, t);
    sum.sign = texture.area() < 0 ? -1 : 1;
    if (texture.area() == 0) return;
    const Vec3d along = (side(1, 0) * texture.v2 - side(2, 0) * texture.v1) * sum.sign;
    const Vec3d a = project(side((k + 1) % 3, k), normal), b = project(side((k + 2) % 3, k), normal);
    sum.direction += project(along, normal) * compute_angle(dot(a, b));
}

}  // namespace

void SplitMesh::divide_for_tangents(const Context& ctx) {
    triangles = list_triangles(view, ctx);
    for (std::size_t f = 0; f < view.face_materials.size(); ++f)
        face_materials.insert(face_materials.end(), view.face(f).size() - 2, view.face_materials[f]);
    view.face_materials = face_materials;
    corners = group_by(all_corners(triangles), positions.size());
    divide_vertices(*this, ctx);
    view.positions = positions;
    view.corners = triangles[0].data();
    view.first = nullptr;
    view.sides = 3;
    view.face_count = triangles.size();
    view.texture = {};
}

std::vector<Tangent> compute_tangents(const SplitMesh& mesh, std::span<const Vec3> normals,
                                      const Context& ctx) {
    std::vector<TangentSum> sums(mesh.positions.size());
    parallel_for(ctx, mesh.corners.size(), kGrain, [&](std::size_t v) {
        for (const std::uint32_t corner : mesh.corners[v]) {
            const std::uint32_t divided = mesh.triangles[corner / 3][corner % 3];
            add_corner(mesh, corner, Vec3d(normals[divided]), sums[divided]);
        }
    });
    std::vector<Tangent> out(sums.size());
    parallel_for(ctx, sums.size(), kGrain, [&](std::size_t v) {
        const Vec3 direction(normalized(sums[v].direction, Vec3d(perpendicular(normals[v]))));
        out[v] = {direction, static_cast<float>(sums[v].sign)};
    });
    return out;
}

}  // namespace coppice::io_internal
