#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "coppice/base/box.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/tetra/bits_stages_internal.h"
#include "coppice/cuda/tetra/refine_kernel_internal.h"
#include "coppice/tetra/lattice/refinement.h"

namespace coppice::cuda {

/// A coarse element in the tetrahedron that owns it.
struct OwnedElement {
    std::uint32_t tetra;  ///< coarse tetrahedron
    std::uint32_t group;  ///< see TetraPattern
};

/// Coarse vertices, edges and faces.
using OwnedElements = std::array<std::span<const OwnedElement>, 3>;

/// A refinement on a device, with additional data for kernels with one thread per fine vertex or per fine
/// edge.
struct DeviceRefinement {
    RefinementView view;                    ///< its arrays
    VertexStars stars;                      ///< of the coarse vertices
    std::span<const Tetra> tetra;           ///< coarse tetrahedra in the order of vertices of the mesh
    std::span<const std::uint32_t> region;  ///< of every coarse tetrahedron
    std::span<const std::uint32_t> first;   ///< first tetrahedron of every region, plus the end
    OwnedElements of;                       ///< by number; unset for vertices without tetrahedra
    /// In the order of their tetrahedra. Consecutive threads should process fine vertices in this order: 32
    /// consecutive vertices are in about 13 regions of the field by number, and in 3 by this order.
    OwnedElements in_order;
    FineNumbers ordered;              ///< numbering of the fine vertices in that order
    std::uint32_t ordered_count = 0;  ///< without vertices that have no tetrahedra
    std::uint32_t vertex_count = 0;   ///< fine
    std::uint32_t edge_count = 0;     ///< fine
    std::uint32_t tetra_count = 0;    ///< fine
    float clearance = 0;              ///< see TetraMesh
    /// The coarse tetrahedra for which a portion of a surface is requested: all, or those of a TetraTile.
    /// @{
    std::uint32_t own_begin = 0, own_end = ~0u;
    bool is_tile() const { return own_begin > 0 || own_end != ~0u; }
    COPPICE_HOST_DEVICE bool is_own(std::uint32_t coarse) const {
        return own_begin <= coarse && coarse < own_end;
    }
    /// @}

    /// Conversion between the number of a fine tetrahedron and its coarse tetrahedron and local number: those
    /// of one coarse tetrahedron are consecutive.
    /// @{
    COPPICE_HOST_DEVICE std::uint32_t tetra_index(std::uint32_t i) const { return i >> (3 * view.levels); }
    COPPICE_HOST_DEVICE std::uint32_t fine_index(std::uint32_t i) const {
        return i & ((1u << (3 * view.levels)) - 1);
    }
    COPPICE_HOST_DEVICE std::uint32_t fine_tetra(std::uint32_t coarse, std::uint32_t fine) const {
        return coarse << (3 * view.levels) | fine;
    }
    /// @}

    /// Returns the coarse tetrahedron that owns the element that contains a fine vertex or edge.
    COPPICE_HOST_DEVICE OwnedElement owner(const FinePlace& place) const {
        if (place.kind == TetraElementKind::inside) return {place.part, TetraPattern::kInside};
        return of[static_cast<std::uint32_t>(place.kind)][place.part];
    }
    /// Returns whether a requested tetrahedron owns a fine vertex.
    COPPICE_HOST_DEVICE bool owns(std::uint32_t vertex) const {
        return is_own(owner(view.vertices.place(vertex)).tetra);
    }
};

/// Keeps the fine vertices that requested tetrahedra own.
struct KeepOwnVertices {
    DeviceRefinement refinement;
    std::span<const std::uint64_t> from;  ///< a bit for each fine vertex
    std::span<std::uint64_t> to;          ///< a bit for each fine vertex
    COPPICE_HOST_DEVICE void operator()(std::uint32_t w) const {
        std::uint64_t kept = 0;
        for (std::uint32_t i = 0; i < 64; ++i) {
            const std::uint64_t bit = from[w] & std::uint64_t{1} << i;
            if (bit != 0 && refinement.owns(64 * w + i)) kept |= bit;
        }
        to[w] = kept;
    }
};

/// Counts these vertices. Waits.
template <class Exec>
std::uint32_t count_own(Exec& exec, const DeviceRefinement& refinement,
                        std::span<const std::uint64_t> vertices) {
    if (!refinement.is_tile()) return rank_bits(exec, vertices).count;
    const auto mark = exec.mark();
    const auto kept = exec.template array<std::uint64_t>(vertices.size());
    exec.each("own vertices", kept.size(), KeepOwnVertices{refinement, vertices, kept});
    const std::uint32_t count = rank_bits(exec, kept).count;
    exec.rewind(mark);
    return count;
}

/// Keeps the fine tetrahedra in requested ones.
struct KeepOwnTetra {
    DeviceRefinement refinement;
    std::span<std::uint64_t> marks;  ///< a bit for each fine tetrahedron
    COPPICE_HOST_DEVICE void operator()(std::uint32_t w) const {
        std::uint64_t kept = 0;
        for (std::uint32_t i = 0; i < 64; ++i) {
            if (refinement.is_own(refinement.tetra_index(64 * w + i))) kept |= std::uint64_t{1} << i;
        }
        marks[w] &= kept;
    }
};

/// Counts the elements that each coarse tetrahedron owns.
struct CountOwned {
    std::span<const TetraTraits> traits;            ///< of every coarse tetrahedron
    std::array<std::span<std::uint32_t>, 3> count;  ///< of every coarse tetrahedron, by kind
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        for (std::uint32_t kind = 0; kind < 3; ++kind) count[kind][t] = 0;
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g)
            count[element_kind(g)][t] += traits[t].owned >> g & 1;
    }
};

/// Lists these elements, and stores their owners by number.
struct NoteOwners {
    std::span<const TetraElements> elements;              ///< of every coarse tetrahedron
    std::span<const TetraTraits> traits;                  ///< of every coarse tetrahedron
    std::array<std::span<const std::uint32_t>, 3> first;  ///< of every coarse tetrahedron, by kind
    std::array<std::span<OwnedElement>, 3> of, in_order;  ///< see DeviceRefinement
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        std::array<std::uint32_t, 3> next{first[0][t], first[1][t], first[2][t]};
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
            if ((traits[t].owned >> g & 1) == 0) continue;
            const std::uint32_t kind = element_kind(g);
            of[kind][elements[t][g]] = {t, g};
            in_order[kind][next[kind]++] = {t, g};
        }
    }
};

/// Writes the number of each row to its items.
struct NoteRows {
    std::span<const std::uint32_t> first;  ///< of every row, plus the end
    std::span<std::uint32_t> row;          ///< of every item
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        for (std::uint32_t i = first[r]; i < first[r + 1]; ++i) row[i] = r;
    }
};

/// Finds the owners of all elements of a refinement with complete other arrays.
template <class Exec>
void find_owners(Exec& exec, const std::array<std::size_t, 3>& elements, DeviceRefinement& out) {
    const std::size_t tetra = out.view.elements.size();
    CountOwned count{out.view.traits, {}};
    NoteOwners note{out.view.elements, out.view.traits, {}, {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
        count.count[k] = exec.template array<std::uint32_t>(tetra + 1);
        note.first[k] = count.count[k];
        note.of[k] = exec.template array<OwnedElement>(elements[k]);
        note.in_order[k] = exec.template array<OwnedElement>(elements[k]);
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
    out.first_around = exec.upload(p.first_around);
    out.around = exec.upload(p.around);
    return out;
}

/// Creates a TetraRefinement, which throws with the reason why the mesh is invalid.
[[noreturn]] inline void refuse_mesh(const TetraMesh& mesh, int levels, const Context& ctx) {
    [[maybe_unused]] const TetraRefinement refusing(mesh, levels, ctx);
    throw DeviceError("the tetrahedra are too flat for a device");
}

/// Describes the coarse tetrahedra, and finds those around each vertex. Returns false if some are invalid.
template <class Exec>
bool describe_coarse(Exec& exec, std::span<TetraElements> elements, std::span<TetraTraits> traits,
                     DeviceRefinement& out) {
    const std::size_t vertices = out.view.positions.size(), corners = 4 * out.tetra.size();
    const auto faulty = exec.template array<std::uint32_t>(1);
    const auto vertex = exec.template array<std::uint32_t>(corners);
    const auto corner = exec.template array<std::uint32_t>(corners);
    exec.clear(faulty);
    exec.each("describe tetrahedra", out.tetra.size(),
              DescribeTetra{out.view.positions, out.tetra, out.view.levels, elements, traits, vertex, corner,
                            faulty});
    exec.sort_pairs(vertex, corner, static_cast<int>(std::bit_width(vertices)));
    const auto first = exec.template array<std::uint32_t>(vertices + 1);
    exec.each("vertex stars", vertices + 1, FindRows{vertex, first});
    out.stars = {first, corner, vertex};
    std::uint32_t found = 0;
    exec.download(std::span<const std::uint32_t>(faulty), std::span(&found, 1));
    return found == 0;
}

/// Finds and numbers the edges and faces of the coarse mesh. Returns the number of edges plus 2^32 times the
/// number of faces, or no value if a face has more than two tetrahedra.
template <class Exec>
std::optional<std::uint64_t> find_elements(Exec& exec, std::span<TetraElements> elements,
                                           std::span<TetraTraits> traits, DeviceRefinement& out) {
    const std::size_t corners = out.stars.corners.size(), vertices = out.view.positions.size();
    const OwnedByCorner owned{exec.template array<std::uint32_t>(corners)};
    const auto faulty = exec.template array<std::uint32_t>(1);
    const auto first = exec.template array<std::uint64_t>(corners + 1);
    exec.clear(faulty);
    exec.each("find elements", corners, FindOwned{out.stars, elements, owned, first, faulty});
    const std::uint64_t counts = place_counts(exec, first);
    std::uint32_t found = 0;
    exec.download(std::span<const std::uint32_t>(faulty), std::span(&found, 1));
    if (found != 0) return {};
    exec.each("number elements", corners, NumberElements{out.stars, owned, first, elements});
    exec.each("owners", out.tetra.size(), NoteOwned{owned, traits});
    const auto edges = static_cast<std::uint32_t>(counts), faces = static_cast<std::uint32_t>(counts >> 32);
    const auto shortest = exec.template array<float>(vertices + edges + faces);
    const auto first_face = static_cast<std::uint32_t>(vertices) + edges;
    out.view.first_element = {0, static_cast<std::uint32_t>(vertices), first_face, first_face + faces};
    exec.each("shortest edges", vertices, BeginShortest{shortest});
    exec.each("shortest edges", corners,
              FindShortest{out.stars, owned, elements, traits, out.view.first_element, shortest});
    out.view.shortest_at = shortest;
    return counts;
}

/// Copies a coarse mesh to an executor, with the subdivision patterns of its tetrahedra. Throws the
/// exceptions of TetraRefinement for errors that are found immediately.
template <class Exec>
DeviceRefinement upload_coarse(Exec& exec, const TetraMesh& mesh, int levels, const Context& ctx = {}) {
    if (levels < 0 || levels > TetraPattern::kMaxLevels || mesh.tetra.size() >= (1u << 29) ||
        mesh.positions.size() >= (1u << 30) || mesh.first.empty() || mesh.first.front() != 0 ||
        mesh.first.back() != mesh.tetra.size() || !std::ranges::is_sorted(mesh.first))
        refuse_mesh(mesh, levels, ctx);
    DeviceRefinement out;
    out.clearance = mesh.clearance;
    out.view.levels = levels;
    out.view.positions = exec.upload(std::span<const Vec3>(mesh.positions));
    out.tetra = exec.upload(std::span<const Tetra>(mesh.tetra));
    out.first = exec.upload(std::span<const std::uint32_t>(mesh.first));
    for (std::uint32_t d = 0; d < 3; ++d) {
        const TetraPattern pattern = tetra_pattern(levels, d);
        out.view.patterns[d] = upload_pattern(exec, make_view(pattern));
        out.view.edges.per_kind = fine_edges_per_part(pattern);
    }
    out.view.vertices.per_kind = fine_vertices_per_part(levels);
    return out;
}

/// Numbers all fine elements for a coarse mesh with these numbers of vertices, edges, faces and tetrahedra.
/// Returns false if that exceeds the limit of TetraRefinement; throws DeviceError if it exceeds the limit of
/// a device.
inline bool number_fine(const std::array<std::uint64_t, 4>& elements, DeviceRefinement& out) {
    const std::uint64_t vertices = out.view.vertices.begin_kinds(elements);
    const std::uint64_t tetra = elements[3] << 3 * out.view.levels;
    out.view.edge_count = out.view.edges.begin_kinds(elements);
    if (vertices > TetraRefinement::kMaxVertices) return false;
    // A scan uses 31 bits.
    constexpr std::uint64_t kMax = std::numeric_limits<std::int32_t>::max() - 1;
    if (out.view.edge_count > kMax || tetra > kMax)
        throw DeviceFull("there are too many tetrahedra for a device");
    out.vertex_count = static_cast<std::uint32_t>(vertices);
    out.edge_count = static_cast<std::uint32_t>(out.view.edge_count);
    out.tetra_count = static_cast<std::uint32_t>(tetra);
    return true;
}

/// Refines an uploaded coarse mesh, with the same numbering as TetraRefinement. About 250 bytes per coarse
/// tetrahedron. Returns false if TetraRefinement would reject the mesh. Waits.
template <class Exec>
bool refine(Exec& exec, DeviceRefinement& out) {
    const std::size_t tetra = out.tetra.size(), vertices = out.view.positions.size();
    const auto elements = exec.template array<TetraElements>(tetra);
    const auto traits = exec.template array<TetraTraits>(tetra);
    out.view.elements = elements;
    out.view.traits = traits;
    if (!describe_coarse(exec, elements, traits, out)) return false;
    const auto counts = find_elements(exec, elements, traits, out);
    if (!counts) return false;
    const std::uint64_t edges = *counts & 0xffffffffu, faces = *counts >> 32;
    if (!number_fine({vertices, edges, faces, tetra}, out)) return false;
    const auto region = exec.template array<std::uint32_t>(tetra);
    exec.each("regions", out.first.size() - 1, NoteRows{out.first, region});
    out.region = region;
    find_owners(exec, {vertices, edges, faces}, out);
    return true;
}

/// Refines a mesh in host memory. Throws the exceptions of TetraRefinement, and DeviceError if it has more
/// than 2^31 fine edges or tetrahedra.
template <class Exec>
DeviceRefinement refine(Exec& exec, const TetraMesh& mesh, int levels, const Context& ctx = {}) {
    DeviceRefinement out = upload_coarse(exec, mesh, levels, ctx);
    if (!refine(exec, out)) refuse_mesh(mesh, levels, ctx);
    return out;
}

/// Computes the bounding box of the tetrahedra of every region.
struct BoundTetra {
    DeviceRefinement refinement;
    std::span<Box3> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        Box3 box;
        for (std::uint32_t t = refinement.first[r]; t < refinement.first[r + 1]; ++t) {
            for (const std::uint32_t v : refinement.tetra[t]) box.extend(refinement.view.positions[v]);
        }
        out[r] = box;
    }
};

/// Returns the boxes of the regions.
template <class Exec>
std::span<const Box3> region_boxes(Exec& exec, const DeviceRefinement& refinement) {
    const auto boxes = exec.template array<Box3>(refinement.first.size() - 1);
    exec.each("bound regions", boxes.size(), BoundTetra{refinement, boxes});
    return boxes;
}

}  // namespace coppice::cuda
