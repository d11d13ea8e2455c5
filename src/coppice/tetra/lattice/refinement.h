#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/tetra/lattice/pattern.h"
#include "coppice/tetra/lattice/refinement_view.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// A tetrahedral mesh subdivided `levels` times, each tetrahedron into eight: four at its corners, and four
/// of the octahedron between them, cut along the shortest diagonal [Zhu2013]. The result is conforming.
///
/// The diagonal is chosen once per coarse tetrahedron, by its shape, and kept on all levels: its descendants
/// then have at most three shapes. The diagonal is in the interior, so any choice is conforming.
///
/// Only the coarse mesh, its edges and its faces are stored, about 100 bytes per coarse tetrahedron. Fine
/// vertices are numbered in closed form: the vertices of the coarse mesh, then those inside its edges, its
/// faces and its tetrahedra. Every coarse tetrahedron has a pattern (see TetraPattern) with corners 0 to 3 at
/// its vertices in ascending order, so that all tetrahedra that share an edge or a face see it in the same
/// order.
class TetraRefinement {
  public:
    using Elements = TetraElements;  ///< see TetraElements
    using Kind = TetraElementKind;   ///< of the coarse element that contains a fine vertex
    using Place = FinePlace;         ///< position of a fine vertex in the coarse mesh

    /// The coarse mesh must outlive this object. Throws InvalidInput naming `levels` if it is out of range or
    /// would create more than kMaxVertices fine vertices, and naming the first tetrahedron that refers to a
    /// vertex that does not exist, has no positive volume, or shares a face with more than one other. O(n).
    TetraRefinement(const TetraMesh& coarse, int levels, const Context& ctx = {});
    TetraRefinement(TetraMesh&&, int, const Context& = {}) = delete;

    static constexpr std::uint64_t kMaxVertices = std::uint64_t{1}
                                                  << 30;  ///< maximum number of fine vertices

    const TetraMesh& coarse() const { return coarse_; }              ///< the coarse mesh
    int levels() const { return levels_; }                           ///< number of subdivisions
    std::uint32_t edge_count() const { return first_edge_.back(); }  ///< coarse
    std::uint32_t face_count() const { return first_face_.back(); }  ///< coarse
    std::uint32_t vertex_count() const { return vertex_count_; }     ///< fine
    std::uint64_t tetra_count() const {                              ///< fine
        return std::uint64_t{coarse_.tetra.size()} << 3 * levels_;
    }

    const Elements& elements(std::uint32_t tetra) const { return elements_[tetra]; }  ///< see Elements
    /// subdivision of a coarse tetrahedron
    const TetraPattern& pattern(std::uint32_t tetra) const { return patterns_[traits_[tetra].diagonal]; }
    /// Returns the number of the diagonal along which it is cut.
    std::uint32_t diagonal(std::uint32_t tetra) const { return traits_[tetra].diagonal; }
    const TetraPattern& pattern_along(std::uint32_t diagonal) const {
        return patterns_[diagonal];
    }  ///< by number
    /// Returns whether the vertices in ascending order have negative orientation.
    bool mirrored(std::uint32_t tetra) const { return traits_[tetra].mirrored; }
    /// Bit g is set if this is the first tetrahedron that contains the element of group g.
    std::uint32_t owned(std::uint32_t tetra) const { return traits_[tetra].owned; }
    /// Returns whether the element of a group is on the hull: in a face of only one tetrahedron.
    bool on_hull(std::uint32_t tetra, std::uint32_t group) const { return shortest_edge(tetra, group) == 0; }
    float shortest_edge(std::uint32_t tetra) const { return traits_[tetra].shortest_edge; }  ///< [m] fine
    /// [m] Minimum over all tetrahedra that contain the element of a group; 0 for elements on the hull.
    float shortest_edge(std::uint32_t tetra, std::uint32_t group) const {
        return group == TetraPattern::kInside ? shortest_edge(tetra) : shortest_at_[part_index(tetra, group)];
    }
    /// [m] Minimum distance of two parallel planes that have a fine tetrahedron between them: it keeps its
    /// orientation as long as each of its vertices moves by less than half of this.
    float width(std::uint32_t tetra) const { return traits_[tetra].width; }

    /// Number of the first fine vertex inside the element of a group; the others follow.
    std::uint32_t first_vertex(std::uint32_t tetra, std::uint32_t group) const {
        return vertices_.first(tetra, elements_[tetra], group);
    }
    /// Returns the number of a fine vertex, given by its local number in a coarse tetrahedron.
    std::uint32_t vertex(std::uint32_t tetra, TetraPattern::Local local) const {
        const TetraPattern& p = pattern(tetra);
        const std::uint32_t group = p.group[local];
        return first_vertex(tetra, group) + (local - p.first_vertex[group]);
    }
    /// Returns the coarse element that contains a fine vertex. O(1).
    Place place(std::uint32_t vertex) const { return vertices_.place(vertex); }
    /// [m] Bit-identical for every coarse tetrahedron that contains the vertex.
    Vec3 position(std::uint32_t tetra, TetraPattern::Local local) const {
        return fine_position(coarse_.positions.data(), elements_[tetra], pattern(tetra).shares[local]);
    }
    /// Returns the same data as spans, which are valid as long as this object.
    RefinementView view() const;

    /// Returns the coarse tetrahedra that contain an element, ascending. O(tetrahedra at one of its
    /// vertices).
    std::vector<std::uint32_t> around(Kind kind, std::uint32_t part) const;
    /// Returns the group of an element in the pattern of a tetrahedron; kGroups if it is not part of it.
    std::uint32_t group_in(std::uint32_t tetra, Kind kind, std::uint32_t part) const;

  private:
    using Traits = TetraTraits;
    void check(const Context& ctx) const;
    void describe(const Context& ctx);
    void find_vertex_stars(const Context& ctx);
    void find_elements(const Context& ctx);

    std::span<const std::uint32_t> at_vertex(std::uint32_t v) const {
        return std::span(at_vertex_)
            .subspan(first_at_vertex_[v], first_at_vertex_[v + 1] - first_at_vertex_[v]);
    }
    void own(std::uint32_t tetra, std::uint32_t group) {
        const auto bit = static_cast<std::uint16_t>(1u << group);
        std::atomic_ref(traits_[tetra].owned).fetch_or(bit, std::memory_order_relaxed);
    }
    /// Index of the element of a group in `shortest_at_`.
    std::size_t part_index(std::uint32_t tetra, std::uint32_t group) const {
        const std::size_t part = elements_[tetra][group];
        return group < 4    ? part
               : group < 10 ? coarse_.positions.size() + part
                            : coarse_.positions.size() + edge_count() + part;
    }

    const TetraMesh& coarse_;
    int levels_;
    std::array<TetraPattern, 3> patterns_;  ///< by diagonal
    Buffer<Elements> elements_;
    Buffer<Traits> traits_;
    Buffer<std::uint32_t> first_at_vertex_, at_vertex_;
    Buffer<std::uint32_t> first_edge_,
        first_face_;             ///< per vertex: elements that have it as their smallest vertex
    Buffer<float> shortest_at_;  ///< vertices, edges, faces
    FineNumbers vertices_;
    std::uint32_t vertex_count_ = 0;
};

}  // namespace coppice
