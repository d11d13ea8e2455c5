#include "coppice/tetra/march/parts_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/box.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/march/closed_parts.h"

namespace coppice::tetra_internal {
namespace {

/// A closed component of the surface.
struct Part {
    std::vector<std::uint32_t> triangles;
    Box3 box;
    double volume6 = 0;
};

/// Returns the solid angle of a triangle seen from the origin, with a sign that depends on the side
/// [VanOosterom1983].
double solid_angle(Vec3d a, Vec3d b, Vec3d c) {
    const double la = length(a), lb = length(b), lc = length(c);
    return 2 *
           std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

bool encloses(const TriMesh& mesh, const Part& part, Vec3 place) {
    if (!part.box.overlaps(Box3{place, place})) return false;
    double sum = 0;
    for (const std::uint32_t t : part.triangles) {
        const auto& [a, b, c] = mesh.triangles[t];
        const auto from = [&](std::uint32_t v) { return Vec3d(mesh.positions[v]) - Vec3d(place); };
        sum += solid_angle(from(a), from(b), from(c));
    }
    return sum > 2 * std::numbers::pi;
}

/// Collects the triangles, box and volume of each component; components are numbered by their first triangle.
std::vector<Part> collect_parts(const TriMesh& mesh, std::span<const std::uint32_t> part_of,
                                std::size_t count) {
    std::vector<Part> parts(count);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        Part& part = parts[part_of[t]];
        part.triangles.push_back(t);
        const auto& [a, b, c] = mesh.triangles[t];
        for (const std::uint32_t v : mesh.triangles[t]) part.box.extend(mesh.positions[v]);
        // Relative to a point of the component, so that rounding does not change the sign far from the
        // origin.
        const Vec3d o(mesh.positions[mesh.triangles[part.triangles[0]][0]]);
        const auto from = [&](std::uint32_t v) { return Vec3d(mesh.positions[v]) - o; };
        part.volume6 += dot(from(a), cross(from(b), from(c)));
    }
    return parts;
}

/// Returns the new number of every vertex, and of one past the end; removed vertices have the number of the
/// next kept one.
std::vector<std::uint32_t> keep_triangles(TriMesh& mesh, std::span<const std::uint32_t> part_of,
                                          std::span<const std::uint8_t> kept) {
    std::vector<std::uint32_t> number(mesh.positions.size() + 1);
    TriMesh out;
    out.origin = mesh.origin;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (kept[part_of[t]] == 0) continue;
        out.triangles.push_back(mesh.triangles[t]);
        for (const std::uint32_t v : mesh.triangles[t]) number[v] = 1;
    }
    out.positions.resize(exclusive_scan(std::span(number)));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if (number[v] != number[v + 1]) out.positions[number[v]] = mesh.positions[v];
    }
    for (Triangle& t : out.triangles) {
        for (std::uint32_t& v : t) v = number[v];
    }
    mesh = std::move(out);
    return number;
}

}  // namespace

std::vector<Vec3> held_places(const TetraRefinement& refinement, const HeldVertices& held,
                              const Samples& samples) {
    std::vector<Vec3> out;
    for (const std::uint32_t i : held.of_each_set) {
        const HeldVertex& h = held.list[i];
        out.push_back(samples.moved.test(h.vertex) ? samples.place[samples.placed.rank(h.vertex)]
                                                   : refinement.position(h.tetra, h.local));
    }
    return out;
}

void drop_bodies(SolidMesh& solid, const DroppedParts& dropped) {
    if (dropped.count == 0 || solid.tetra.empty()) return;
    DisjointSets bodies(solid.positions.size());
    for (const auto& t : solid.tetra) {
        for (const std::uint32_t v : t) bodies.join(t[0], v);
    }
    std::vector<std::uint8_t> gone(solid.positions.size());
    for (std::uint32_t v = 0; v + 1 < dropped.number.size(); ++v) {
        if (dropped.number[v] == dropped.number[v + 1]) gone[bodies.find(v)] = 1;
    }
    std::erase_if(solid.tetra, [&](const auto& t) { return gone[bodies.find(t[0])] != 0; });
    compact(solid);
}

void compact(SolidMesh& solid) {
    std::vector<std::uint32_t> number(solid.positions.size() + 1);
    for (const auto& t : solid.tetra) {
        for (const std::uint32_t v : t) number[v] = 1;
    }
    Buffer<Vec3> positions(exclusive_scan(std::span(number)));
    for (std::size_t v = 0; v < solid.positions.size(); ++v) {
        if (number[v] != number[v + 1]) positions[number[v]] = solid.positions[v];
    }
    solid.positions = std::move(positions);
    for (auto& t : solid.tetra) {
        for (std::uint32_t& v : t) v = number[v];
    }
}

}  // namespace coppice::tetra_internal

namespace coppice {

std::vector<std::uint8_t> enclosing_parts(const TriMesh& mesh, std::span<const std::uint32_t> part_of,
                                          std::size_t count, std::span<const Vec3> places, bool with_hollows,
                                          const Context& ctx) {
    const std::vector<tetra_internal::Part> parts = tetra_internal::collect_parts(mesh, part_of, count);
    std::vector<std::uint8_t> kept(count);
    parallel_for(ctx, count, 1, [&](std::size_t p) {
        const bool is_hollow = parts[p].volume6 <= 0;
        const auto is_inside = [&](Vec3 place) { return tetra_internal::encloses(mesh, parts[p], place); };
        kept[p] = is_hollow ? !with_hollows : std::ranges::any_of(places, is_inside);
    });
    return kept;
}

DroppedParts drop_parts(TriMesh& mesh, std::span<const Vec3> places, bool with_hollows, const Context& ctx) {
    // Neighbours are consecutive in the list, so there is not enough work for more threads.
    DisjointSets sets(mesh.positions.size());
    std::size_t count = mesh.positions.size();
    for (const Triangle& t : mesh.triangles)
        count -= (sets.join(t[0], t[1]) ? 1 : 0) + (sets.join(t[0], t[2]) ? 1 : 0);
    ctx.throw_if_cancelled();
    // A surface that encloses all axes has at least one component that is not a hollow.
    if (count <= 1) return {};
    constexpr std::uint32_t kUnseen = 0xffffffffu;
    std::vector<std::uint32_t> part_of_root(mesh.positions.size(), kUnseen), part_of(mesh.triangles.size());
    std::uint32_t next = 0;
    for (std::size_t t = 0; t < part_of.size(); ++t) {
        std::uint32_t& part = part_of_root[sets.find(mesh.triangles[t][0])];
        if (part == kUnseen) part = next++;
        part_of[t] = part;
    }
    const std::vector<std::uint8_t> kept = enclosing_parts(mesh, part_of, count, places, with_hollows, ctx);
    DroppedParts dropped;
    dropped.count = static_cast<std::uint64_t>(std::ranges::count(kept, 0));
    if (dropped.count > 0) dropped.number = tetra_internal::keep_triangles(mesh, part_of, kept);
    return dropped;
}

}  // namespace coppice
