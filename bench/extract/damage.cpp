#include "damage.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/base/sort.h"

namespace coppice::bench {
namespace {

std::vector<Vec3d> compute_normals(const PolygonMesh& mesh) {
    std::vector<Vec3d> normals(mesh.positions.size());
    const TriMesh triangles = triangulate(mesh);
    for (const Triangle& t : triangles.triangles) {
        const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        for (const std::uint32_t v : t) normals[v] += cross(b - a, c - a);
    }
    for (Vec3d& n : normals) n = normalized(n);
    return normals;
}

Vec3d middle(const PolygonMesh& mesh, std::uint32_t face) {
    Vec3d sum;
    for (const std::uint32_t v : mesh.face(face)) sum += Vec3d(mesh.positions[v]);
    return sum / static_cast<double>(mesh.face(face).size());
}

/// Returns the neighbours of every vertex, sorted.
std::vector<std::vector<std::uint32_t>> find_neighbours(const TriMesh& mesh) {
    std::vector<std::vector<std::uint32_t>> of(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            of[t[k]].push_back(t[(k + 1) % 3]);
            of[t[k]].push_back(t[(k + 2) % 3]);
        }
    }
    for (auto& n : of) {
        sort_unique(n);
    }
    return of;
}

/// Replaces vertices by their targets, and removes unused ones.
void renumber(TriMesh& mesh, const std::vector<std::uint32_t>& target) {
    std::vector<std::uint32_t> number(target.size());
    Buffer<Vec3> positions;
    for (std::uint32_t v = 0; v < target.size(); ++v) {
        if (target[v] != v) continue;
        number[v] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions[v]);
    }
    Buffer<Triangle> triangles;
    for (Triangle t : mesh.triangles) {
        for (std::uint32_t& v : t) v = number[target[v]];
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
}

/// Collapses at most `most` edges, no two of which have neighbours in common; returns false if there is no
/// such edge. The ends of an edge must have exactly two common neighbours, and more than that together;
/// otherwise a tube or a tetrahedron would close.
bool collapse_once(TriMesh& mesh, std::size_t most, const CounterRandom& random) {
    const auto neighbours = find_neighbours(mesh);
    std::vector<char> touched(mesh.positions.size());
    std::vector<std::uint32_t> target(mesh.positions.size());
    std::iota(target.begin(), target.end(), 0u);
    std::vector<std::uint32_t> order = target;
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return random.bits(a) < random.bits(b); });
    std::size_t collapsed = 0;
    for (const std::uint32_t a : order) {
        const auto& around = neighbours[a];
        const auto is_touched = [&](std::uint32_t v) { return touched[v] != 0; };
        if (collapsed == most || touched[a] || around.empty()) continue;
        const std::uint32_t b = *std::min_element(around.begin(), around.end(), [&](auto x, auto y) {
            return distance(mesh.positions[a], mesh.positions[x]) <
                   distance(mesh.positions[a], mesh.positions[y]);
        });
        std::vector<std::uint32_t> common;
        std::ranges::set_intersection(around, neighbours[b], std::back_inserter(common));
        if (common.size() != 2 || around.size() + neighbours[b].size() <= 7) continue;
        if (std::ranges::any_of(around, is_touched) || std::ranges::any_of(neighbours[b], is_touched))
            continue;
        mesh.positions[a] = (mesh.positions[a] + mesh.positions[b]) * 0.5f;
        target[b] = a;
        for (const std::uint32_t v : around) touched[v] = 1;
        for (const std::uint32_t v : neighbours[b]) touched[v] = 1;
        ++collapsed;
    }
    renumber(mesh, target);
    return collapsed > 0;
}

}  // namespace

PolygonMesh roughened(const PolygonMesh& mesh, double noise, std::uint64_t seed) {
    const std::vector<Vec3d> normals = compute_normals(mesh);
    const CounterRandom random(seed, 0);
    PolygonMesh out = mesh;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const double radius = std::sqrt(-2 * std::log(1 - random.uniform(2 * v)));
        const double normal = radius * std::cos(2 * std::numbers::pi * random.uniform(2 * v + 1));
        out.positions[v] = Vec3(Vec3d(mesh.positions[v]) + normals[v] * (noise * normal));
    }
    return out;
}

PolygonMesh with_holes(const PolygonMesh& mesh, std::uint32_t count, double radius, std::uint64_t seed) {
    const CounterRandom random(seed, 1);
    std::vector<Vec3d> holes;
    for (std::uint32_t i = 0; i < count; ++i)
        holes.emplace_back(mesh.positions[random.bits(i) % mesh.positions.size()]);
    PolygonMesh out;
    out.positions = mesh.positions;
    out.origin = mesh.origin;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const Vec3d m = middle(mesh, f);
        const auto near = [&](Vec3d hole) { return length_squared(m - hole) < radius * radius; };
        if (std::none_of(holes.begin(), holes.end(), near)) out.add_face(mesh.face(f));
    }
    return out;
}

PolygonMesh decimated(const PolygonMesh& mesh, double share, std::uint64_t seed) {
    TriMesh out = triangulate(mesh);
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(out.positions.size()));
    for (std::uint64_t round = 0; out.positions.size() > wanted; ++round) {
        if (!collapse_once(out, out.positions.size() - wanted, CounterRandom(seed, 2 + round))) break;
    }
    PolygonMesh polygons;
    polygons.positions = std::move(out.positions);
    polygons.origin = out.origin;
    for (const Triangle& t : out.triangles) polygons.add_face(t);
    return polygons;
}

}  // namespace coppice::bench
