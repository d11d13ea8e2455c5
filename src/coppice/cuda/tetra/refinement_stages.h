#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/device.h"
#include "coppice/tetra/lattice/refinement.h"

namespace coppice::cuda {

/// A coarse part, as the first tetrahedron that has it sees it.
struct OwnedPart {
    std::uint32_t tetra;  ///< a coarse one
    std::uint32_t group;  ///< see TetraPattern
};

/// Coarse vertices, edges and faces.
using OwnedParts = std::array<std::span<const OwnedPart>, 3>;

/// A refinement on a device, with what a thread per fine vertex or per fine edge needs besides.
struct DeviceRefinement {
    RefinementView view;                    ///< its arrays
    std::span<const std::uint32_t> region;  ///< of every coarse tetrahedron
    OwnedParts of;                          ///< by number; nothing for vertices of no tetrahedron
    /// In the order of their tetrahedra. Threads that follow each other should take fine vertices by this
    /// order: by number, some 32 of them lie in 13 regions of the field, by this order in 3.
    OwnedParts in_order;
    FineNumbers ordered;              ///< numbers the fine vertices in that order
    std::uint32_t ordered_count = 0;  ///< but for those of no tetrahedron
    std::uint32_t vertex_count = 0;   ///< fine ones
    std::uint32_t edge_count = 0;     ///< fine ones
    std::uint32_t tetra_count = 0;    ///< fine ones
    float clearance = 0;              ///< see TetraMesh

    /// Of a fine tetrahedron the coarse one, and its number there: those of a coarse one follow each other.
    /// @{
    COPPICE_HOST_DEVICE std::uint32_t tetra_of(std::uint32_t i) const { return i >> (3 * view.levels); }
    COPPICE_HOST_DEVICE std::uint32_t fine_of(std::uint32_t i) const {
        return i & ((1u << (3 * view.levels)) - 1);
    }
    /// @}

    /// The first coarse tetrahedron that has the part in which a fine vertex, or edge, lies.
    COPPICE_HOST_DEVICE OwnedPart owner(const FinePlace& place) const {
        if (place.kind == TetraPartKind::inside) return {place.part, TetraPattern::kInside};
        return of[static_cast<std::uint32_t>(place.kind)][place.part];
    }
};

/// Counts the parts that each coarse tetrahedron is the first of.
struct CountOwned {
    std::span<const TetraTraits> traits;            ///< of every coarse tetrahedron
    std::array<std::span<std::uint32_t>, 3> count;  ///< of every coarse tetrahedron, by kind
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        for (std::uint32_t kind = 0; kind < 3; ++kind) count[kind][t] = 0;
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g)
            count[part_kind(g)][t] += traits[t].owned >> g & 1;
    }
};

/// Lists these parts, and notes them by their numbers.
struct NoteOwners {
    std::span<const TetraParts> parts;                    ///< of every coarse tetrahedron
    std::span<const TetraTraits> traits;                  ///< of every coarse tetrahedron
    std::array<std::span<const std::uint32_t>, 3> first;  ///< of every coarse tetrahedron, in order
    std::array<std::span<OwnedPart>, 3> of, in_order;     ///< see DeviceRefinement
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        std::array<std::uint32_t, 3> next{first[0][t], first[1][t], first[2][t]};
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
            if ((traits[t].owned >> g & 1) == 0) continue;
            const std::uint32_t kind = part_kind(g);
            of[kind][parts[t][g]] = {t, g};
            in_order[kind][next[kind]++] = {t, g};
        }
    }
};

/// Each region names itself to its coarse tetrahedra.
struct NoteRegions {
    std::span<const std::uint32_t> first;  ///< see TetraMesh
    std::span<std::uint32_t> region;       ///< of every coarse tetrahedron
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        for (std::uint32_t t = first[r]; t < first[r + 1]; ++t) region[t] = r;
    }
};

/// Replaces all counts but the last by the sum of those before, and the last by the sum of all; returns it.
template <class Exec, class T>
T place_counts(Exec& exec, std::span<T> counts) {
    exec.clear(counts.last(1));
    exec.exclusive_scan(std::span<const T>(counts), counts);
    T total{};
    exec.download(std::span<const T>(counts.last(1)), std::span(&total, 1));
    return total;
}

/// Finds the owners of all parts of a refinement, whose other arrays are there.
template <class Exec>
void find_owners(Exec& exec, const std::array<std::size_t, 3>& parts, DeviceRefinement& out) {
    const std::size_t tetra = out.view.parts.size();
    CountOwned count{out.view.traits, {}};
    NoteOwners note{out.view.parts, out.view.traits, {}, {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
        count.count[k] = exec.template array<std::uint32_t>(tetra + 1);
        note.first[k] = count.count[k];
        note.of[k] = exec.template array<OwnedPart>(parts[k]);
        note.in_order[k] = exec.template array<OwnedPart>(parts[k]);
        out.of[k] = note.of[k];
    }
    exec.each("owners", tetra, count);
    out.ordered.per_kind = out.view.vertices.per_kind;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t owned = place_counts(exec, count.count[k]);
        out.in_order[k] = note.in_order[k].first(owned);
        out.ordered.first_of_kind[k + 1] = out.ordered.first_of_kind[k] + owned * out.ordered.per_kind[k];
    }
    out.ordered_count =
        out.ordered.first_of_kind[3] + static_cast<std::uint32_t>(tetra) * out.ordered.per_kind[3];
    exec.each("owners", tetra, note);
}

/// Copies a pattern to a device.
template <class Exec>
PatternView upload_pattern(Exec& exec, const PatternView& p) {
    PatternView out = p;
    out.shares = exec.upload(p.shares);
    out.group = exec.upload(p.group);
    out.tetra = exec.upload(p.tetra);
    out.edges = exec.upload(p.edges);
    out.edge_group = exec.upload(p.edge_group);
    out.tetra_edges = exec.upload(p.tetra_edges);
    return out;
}

/// Copies a refinement to a device, some 160 bytes per coarse tetrahedron. Throws DeviceError when it has
/// more than 2^31 fine edges or tetrahedra.
template <class Exec>
DeviceRefinement upload_refinement(Exec& exec, const TetraRefinement& refinement) {
    const RefinementView host = refinement.view();
    const TetraMesh& mesh = refinement.coarse();
    // A scan counts in 31 bits.
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max() - 1;
    if (host.edge_count > kMost || refinement.tetra_count() > kMost)
        throw DeviceError("there are too many tetrahedra for a device");
    DeviceRefinement out;
    out.vertex_count = refinement.vertex_count();
    out.edge_count = static_cast<std::uint32_t>(host.edge_count);
    out.tetra_count = static_cast<std::uint32_t>(refinement.tetra_count());
    out.clearance = mesh.clearance;
    out.view = host;
    out.view.positions = exec.upload(host.positions);
    out.view.parts = exec.upload(host.parts);
    out.view.traits = exec.upload(host.traits);
    out.view.shortest_at = exec.upload(host.shortest_at);
    for (std::size_t d = 0; d < 3; ++d) out.view.patterns[d] = upload_pattern(exec, host.patterns[d]);

    const auto region = exec.template array<std::uint32_t>(mesh.tetra.size());
    exec.each("regions", mesh.region_count(),
              NoteRegions{exec.upload(std::span<const std::uint32_t>(mesh.first)), region});
    out.region = region;
    find_owners(exec, {mesh.positions.size(), refinement.edge_count(), refinement.face_count()}, out);
    return out;
}

}  // namespace coppice::cuda
