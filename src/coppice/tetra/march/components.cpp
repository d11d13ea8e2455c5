#include "coppice/tetra/march/components_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/box.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/march/closed_components.h"

namespace coppice::tetra_internal {
namespace {

/// A closed component of the surface.
struct Component {
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

bool encloses(const TriMesh& mesh, const Component& component, Vec3 place) {
    if (!component.box.overlaps(Box3{place, place})) return false;
    double sum = 0;
    for (const std::uint32_t t : component.triangles) {
        const auto& [a, b, c] = mesh.triangles[t];
        const auto from = [&](std::uint32_t v) { return Vec3d(mesh.positions[v]) - Vec3d(place); };
        sum += solid_angle(from(a), from(b), from(c));
    }
    return sum > 2 * std::numbers::pi;
}

/// Collects the triangles, box and volume of each component; components are numbered by their first triangle.
std::vector<Component> collect_components(const TriMesh& mesh, std::span<const std::uint32_t> component_of,
                                          std::size_t count) {
    std::vector<Component> components(count);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        Component& component = components[component_of[t]];
        component.triangles.push_back(t);
        const auto& [a, b, c] = mesh.triangles[t];
        for (const std::uint32_t v : mesh.triangles[t]) component.box.extend(mesh.positions[v]);
        // Relative to a point of the component, so that rounding does not change the sign far from the
        // origin.
        const Vec3d o(mesh.positions[mesh.triangles[component.triangles[0]][0]]);
        const auto from = [&](std::uint32_t v) { return Vec3d(mesh.positions[v]) - o; };
        component.volume6 += dot(from(a), cross(from(b), from(c)));
    }
    return components;
}

/// Returns the new number of every vertex, and of one past the end; removed vertices have the number of the
/// next kept one.
std::vector<std::uint32_t> keep_triangles(TriMesh& mesh, std::span<const std::uint32_t> component_of,
                                          std::span<const std::uint8_t> kept) {
    std::vector<std::uint32_t> number(mesh.positions.size() + 1);
    TriMesh out;
    out.origin = mesh.origin;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (kept[component_of[t]] == 0) continue;
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

void drop_bodies(SolidMesh& solid, const RemovedComponents& dropped) {
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

std::vector<std::uint8_t> enclosing_components(const TriMesh& mesh,
                                               std::span<const std::uint32_t> component_of, std::size_t count,
                                               std::span<const Vec3> places, bool with_hollows,
                                               const Context& ctx) {
    const std::vector<tetra_internal::Component> components =
        tetra_internal::collect_components(mesh, component_of, count);
    std::vector<std::uint8_t> kept(count);
    parallel_for(ctx, count, 1, [&](std::size_t p) {
        const bool is_hollow = components[p].volume6 <= 0;
        const auto is_inside = [&](Vec3 place) {
            return tetra_internal::encloses(mesh, components[p], place);
        };
        kept[p] = is_hollow ? !with_hollows : std::ranges::any_of(places, is_inside);
    });
    return kept;
}

RemovedComponents drop_parts(TriMesh& mesh, std::span<const Vec3> places, bool with_hollows,
                             const Context& ctx) {
    // Neighbours are consecutive in the list, so there is not enough work for more threads.
    DisjointSets sets(mesh.positions.size());
    std::size_t count = mesh.positions.size();
    for (const Triangle& t : mesh.triangles)
        count -= (sets.join(t[0], t[1]) ? 1 : 0) + (sets.join(t[0], t[2]) ? 1 : 0);
    ctx.throw_if_cancelled();
    // A surface that encloses all axes has at least one component that is not a hollow.
    if (count <= 1) return {};
    constexpr std::uint32_t kUnseen = 0xffffffffu;
    std::vector<std::uint32_t> component_of_root(mesh.positions.size(), kUnseen),
        component_of(mesh.triangles.size());
    std::uint32_t next = 0;
    for (std::size_t t = 0; t < component_of.size(); ++t) {
        std::uint32_t& component = component_of_root[sets.find(mesh.triangles[t][0])];
        if (component == kUnseen) component = next++;
        component_of[t] = component;
    }
    const std::vector<std::uint8_t> kept =
        enclosing_components(mesh, component_of, count, places, with_hollows, ctx);
    RemovedComponents dropped;
    dropped.count = static_cast<std::uint64_t>(std::ranges::count(kept, 0));
    if (dropped.count > 0) dropped.number = tetra_internal::keep_triangles(mesh, component_of, kept);
    return dropped;
}

}  // namespace coppice
