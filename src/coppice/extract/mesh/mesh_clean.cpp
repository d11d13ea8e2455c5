#include "coppice/extract/mesh/mesh_clean.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/extract/mesh/surface_internal.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

using extract_internal::Surface;

constexpr double kFinestWeld = 0x1p-52;
// a tube has shares of 0.5 and 0.5 of its normals, a folded leaf 0.7 and 0.3
constexpr double kFlatShare = 0.8;

/// Returns for each group whether it is wood; true for all if no names are specified.
std::vector<char> wooden_groups(const PolygonMesh& mesh, const CleanMeshOptions& options) {
    std::vector<char> wooden(mesh.group_names.size(), options.wood.empty());
    bool any = options.wood.empty();
    for (std::size_t g = 0; g < wooden.size(); ++g) {
        for (const std::string& name : options.wood) {
            if (to_lower(mesh.group_names[g]).find(to_lower(name)) == std::string::npos) continue;
            wooden[g] = 1;
            any = true;
        }
    }
    if (any) return wooden;
    if (mesh.group_names.empty())
        throw InvalidInput(fmt::format("no group is named {}: the mesh has no named groups; omit wood",
                                       fmt::join(options.wood, " or ")));
    throw InvalidInput(fmt::format("no group is named {}; there are {}", fmt::join(options.wood, " or "),
                                   fmt::join(mesh.group_names, ", ")));
}

std::vector<Triangle> wooden_triangles(const PolygonMesh& mesh, const CleanMeshOptions& options,
                                       MeshRepairs& repairs) {
    COPPICE_ASSERT(mesh.group.empty() || mesh.group.size() == mesh.face_count());
    const std::vector<char> wooden = wooden_groups(mesh, options);
    std::vector<Triangle> out;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        if (!mesh.group.empty() && !wooden[mesh.group[f]]) {
            ++repairs.other_material;
            continue;
        }
        for_each_triangle(mesh.face(f), mesh.positions, [&](const Triangle& t) { out.push_back(t); });
    }
    return out;
}

/// Returns for each vertex the first vertex in the same grid cell of size `weld` times the size of the mesh.
std::vector<std::uint32_t> same_place(std::span<const Vec3> positions, double weld, const Context& ctx) {
    struct Place {
        std::uint64_t hash;
        std::uint32_t vertex;
    };
    Box3 box;
    for (const Vec3 p : positions) box.extend(p);
    // Cells below the precision of a double would overflow: positions are then compared exactly.
    const double cell = weld < kFinestWeld ? 0 : weld * box.diagonal();
    const auto compute_cell = [&](Vec3 p) {
        std::array<std::int64_t, 3> c{};
        for (int k = 0; k < 3; ++k)
            c[static_cast<std::size_t>(k)] =
                cell > 0 ? std::llround((static_cast<double>(p[k]) - box.low[k]) / cell)
                         : static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(p[k] + 0.0f));
        return c;
    };
    Buffer<Place> places(positions.size());
    parallel_for(ctx, positions.size(), 8192, [&](std::size_t v) {
        const auto c = compute_cell(positions[v]);
        std::uint64_t hash = 0;
        for (const std::int64_t k : c) hash = mix_bits(hash ^ static_cast<std::uint64_t>(k));
        places[v] = {hash >> 20, static_cast<std::uint32_t>(v)};
    });
    radix_sort(ctx, places, 44, [](const Place& p) { return p.hash; });
    std::vector<std::uint32_t> first(positions.size());
    std::iota(first.begin(), first.end(), 0u);
    for (std::size_t i = 0; i < places.size();) {
        std::size_t end = i + 1;
        while (end < places.size() && places[end].hash == places[i].hash) ++end;
        for (std::size_t k = i + 1; k < end; ++k) {
            // Different cells rarely share a hash: compare with the few preceding ones.
            for (std::size_t j = i; j < k; ++j) {
                if (first[places[j].vertex] != places[j].vertex) continue;
                if (compute_cell(positions[places[j].vertex]) != compute_cell(positions[places[k].vertex]))
                    continue;
                first[places[k].vertex] = places[j].vertex;
                break;
            }
        }
        i = end;
    }
    return first;
}

/// Removes triangles with repeated corner indices and duplicates.
void drop_bad_triangles(std::vector<Triangle>& triangles, MeshRepairs& repairs) {
    repairs.degenerate += static_cast<std::uint32_t>(std::erase_if(
        triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }));
    struct Key {
        Triangle corners;
        std::uint32_t triangle;
    };
    std::vector<Key> keys;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        keys.push_back({triangles[t], t});
        std::sort(keys.back().corners.begin(), keys.back().corners.end());
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.triangle < b.triangle;
    });
    std::vector<char> duplicate(triangles.size(), 0);
    for (std::size_t k = 1; k < keys.size(); ++k)
        if (keys[k].corners == keys[k - 1].corners) duplicate[keys[k].triangle] = 1;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (!duplicate[t]) triangles[kept++] = triangles[t];
    repairs.duplicates += static_cast<std::uint32_t>(triangles.size() - kept);
    triangles.resize(kept);
}

/// Removes unused vertices; keeps the order of the others.
void drop_unused(Surface& s) {
    std::vector<std::uint32_t> index(s.size(), kNoIndex);
    for (const Triangle& t : s.triangles)
        for (const std::uint32_t v : t) index[v] = 0;
    std::uint32_t count = 0;
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        if (index[v] == kNoIndex) continue;
        s.positions[count] = s.positions[v];
        index[v] = count++;
    }
    s.positions.resize(count);
    for (Triangle& t : s.triangles)
        for (std::uint32_t& v : t) v = index[v];
}

/// Returns for each component whether it is flat: most of its area has one normal direction or its opposite.
std::vector<char> flat_pieces(const Surface& s) {
    struct Spread {
        Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
    };
    std::vector<Spread> spread(s.component_count);
    for (const Triangle& t : s.triangles) {
        const Vec3d a(s.positions[t[0]]);
        const Vec3d n = cross(Vec3d(s.positions[t[1]]) - a, Vec3d(s.positions[t[2]]) - a);
        const double l = length(n);
        if (!(l > 0)) continue;
        const Eigen::Vector3d v(n.x, n.y, n.z);
        spread[s.component[t[0]]].normals += v * v.transpose() / l;
    }
    std::vector<char> flat(s.component_count, 0);
    for (std::size_t c = 0; c < flat.size(); ++c) {
        const double area = spread[c].normals.trace();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread[c].normals,
                                                                    Eigen::EigenvaluesOnly);
        flat[c] = !(area > 0) || solver.eigenvalues()[2] > kFlatShare * area;
    }
    return flat;
}

void drop_cards(Surface& s, MeshRepairs& repairs) {
    const std::vector<char> flat = flat_pieces(s);
    const auto count = static_cast<std::uint32_t>(std::count(flat.begin(), flat.end(), 1));
    if (count == 0) return;
    if (count == s.component_count)
        throw InvalidInput(
            "every component of the mesh is flat, like leaves or ground: there is no wood in it");
    repairs.cards = count;
    repairs.card_faces = static_cast<std::uint32_t>(
        std::erase_if(s.triangles, [&](const Triangle& t) { return flat[s.component[t[0]]] != 0; }));
    drop_unused(s);
}

}  // namespace

CleanMeshResult clean_mesh(const PolygonMesh& mesh, const CleanMeshOptions& options, const Context& ctx) {
    validate(mesh);
    CleanMeshResult out;
    Surface s;
    s.positions = mesh.positions;
    s.triangles = wooden_triangles(mesh, options, out.repairs);
    drop_unused(s);
    ctx.throw_if_cancelled();
    const std::vector<std::uint32_t> first = same_place(s.positions, options.weld, ctx);
    for (Triangle& t : s.triangles)
        for (std::uint32_t& v : t) v = first[v];
    for (std::uint32_t v = 0; v < s.size(); ++v) out.repairs.welded += first[v] != v;
    drop_bad_triangles(s.triangles, out.repairs);
    drop_unused(s);
    if (s.triangles.empty()) throw InvalidInput("the mesh has no face with an area");
    extract_internal::SurfaceFindings found = connect(s, ctx);
    if (options.cards) {
        drop_cards(s, out.repairs);
        if (out.repairs.cards > 0) found = connect(s, ctx);
    }
    ctx.throw_if_cancelled();
    out.repairs.open_edges = found.open_edges;
    out.repairs.non_manifold_edges = found.non_manifold_edges;
    out.repairs.flipped = orient(s);
    out.mesh.positions = std::move(s.positions);
    out.mesh.triangles.assign(s.triangles.begin(), s.triangles.end());
    out.mesh.origin = mesh.origin;
    return out;
}

}  // namespace coppice
