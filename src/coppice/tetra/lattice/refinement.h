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

/// A tetrahedral mesh subdivided some times, each tetrahedron into eight: four at its corners, and four of
/// the octahedron between them, cut along the shortest diagonal [Zhu2013]. What comes out is conforming
/// again.
///
/// The diagonal is chosen once per coarse tetrahedron, by its own shape, and kept on all levels: its
/// descendants then have three shapes at most. It lies inside, so any choice conforms.
///
/// Nothing but the coarse mesh, its edges and its faces is stored, some 100 bytes per coarse tetrahedron.
/// Fine vertices are numbered in closed form: those of the coarse mesh, then those inside its edges, its
/// faces and its tetrahedra. To every coarse tetrahedron belongs a pattern (see TetraPattern) whose corners 0
/// to 3 are its vertices in ascending order, so that all who share an edge or a face see it in the same
/// order.
class TetraRefinement {
  public:
    using Parts = TetraParts;    ///< see there
    using Kind = TetraPartKind;  ///< of the coarse part that a fine vertex lies in
    using Place = FinePlace;     ///< where a fine vertex lies

    /// The coarse mesh must outlive this. Throws InvalidInput naming `levels` when out of range or when more
    /// than kMostVertices fine vertices would come out, and naming the first tetrahedron that refers to a
    /// vertex that does not exist, has no positive volume, or shares a face with more than one other. O(n).
    TetraRefinement(const TetraMesh& coarse, int levels, const Context& ctx = {});
    TetraRefinement(TetraMesh&&, int, const Context& = {}) = delete;

    static constexpr std::uint64_t kMostVertices = std::uint64_t{1} << 30;  ///< fine ones

    const TetraMesh& coarse() const { return coarse_; }              ///< the mesh it was made of
    int levels() const { return levels_; }                           ///< times that it is refined
    std::uint32_t edge_count() const { return first_edge_.back(); }  ///< coarse ones
    std::uint32_t face_count() const { return first_face_.back(); }  ///< coarse ones
    std::uint32_t vertex_count() const { return vertex_count_; }     ///< fine
    std::uint64_t tetra_count() const {                              ///< fine
        return std::uint64_t{coarse_.tetra.size()} << 3 * levels_;
    }

    const Parts& parts(std::uint32_t tetra) const { return parts_[tetra]; }  ///< see Parts
    /// how a coarse tetrahedron is cut
    const TetraPattern& pattern(std::uint32_t tetra) const { return patterns_[traits_[tetra].diagonal]; }
    /// The number of the diagonal along which it is cut.
    std::uint32_t diagonal(std::uint32_t tetra) const { return traits_[tetra].diagonal; }
    const TetraPattern& pattern_along(std::uint32_t diagonal) const {
        return patterns_[diagonal];
    }  ///< by number
    /// Whether the ascending order of the vertices is a negative one.
    bool mirrored(std::uint32_t tetra) const { return traits_[tetra].mirrored; }
    /// Bit g is set when the part of group g has this as its first tetrahedron.
    std::uint32_t owned(std::uint32_t tetra) const { return traits_[tetra].owned; }
    /// Whether the part of a group lies on the hull: in a face of one tetrahedron alone.
    bool on_hull(std::uint32_t tetra, std::uint32_t group) const { return shortest_edge(tetra, group) == 0; }
    float shortest_edge(std::uint32_t tetra) const { return traits_[tetra].shortest_edge; }  ///< [m] fine
    /// [m] Of all tetrahedra that have the part of a group; 0 for what lies on the hull.
    float shortest_edge(std::uint32_t tetra, std::uint32_t group) const {
        return group == TetraPattern::kInside ? shortest_edge(tetra) : shortest_at_[part_index(tetra, group)];
    }
    /// [m] Least distance of two parallel planes that have a fine tetrahedron between them: while each of its
    /// vertices moves by less than half of this, it keeps its orientation.
    float width(std::uint32_t tetra) const { return traits_[tetra].width; }

    /// Number of the first fine vertex inside the part of a group; the others follow.
    std::uint32_t first_vertex(std::uint32_t tetra, std::uint32_t group) const {
        return vertices_.first(tetra, parts_[tetra], group);
    }
    /// The number of a fine vertex that one coarse tetrahedron sees.
    std::uint32_t vertex(std::uint32_t tetra, TetraPattern::Local local) const {
        const TetraPattern& p = pattern(tetra);
        const std::uint32_t group = p.group[local];
        return first_vertex(tetra, group) + (local - p.first_vertex[group]);
    }
    /// Where a fine vertex lies. O(1).
    Place place(std::uint32_t vertex) const { return vertices_.place(vertex); }
    /// [m] The same bits from every coarse tetrahedron that has the vertex.
    Vec3 position(std::uint32_t tetra, TetraPattern::Local local) const {
        return fine_position(coarse_.positions.data(), parts_[tetra], pattern(tetra).shares[local]);
    }
    /// The same as spans. They end with this.
    RefinementView view() const;

    /// The coarse tetrahedra that have a part, ascending. O(those that have one of its vertices).
    std::vector<std::uint32_t> around(Kind kind, std::uint32_t part) const;
    /// The number of a part within a tetrahedron, as a group of the pattern; kGroups when it is not there.
    std::uint32_t group_in(std::uint32_t tetra, Kind kind, std::uint32_t part) const;

  private:
    using Traits = TetraTraits;
    void check(const Context& ctx) const;
    void describe(const Context& ctx);
    void find_vertex_stars(const Context& ctx);
    void find_parts(const Context& ctx);

    std::span<const std::uint32_t> at_vertex(std::uint32_t v) const {
        return std::span(at_vertex_)
            .subspan(first_at_vertex_[v], first_at_vertex_[v + 1] - first_at_vertex_[v]);
    }
    void own(std::uint32_t tetra, std::uint32_t group) {
        const auto bit = static_cast<std::uint16_t>(1u << group);
        std::atomic_ref(traits_[tetra].owned).fetch_or(bit, std::memory_order_relaxed);
    }
    /// Place of the part of a group in `shortest_at_`.
    std::size_t part_index(std::uint32_t tetra, std::uint32_t group) const {
        const std::size_t part = parts_[tetra][group];
        return group < 4    ? part
               : group < 10 ? coarse_.positions.size() + part
                            : coarse_.positions.size() + edge_count() + part;
    }

    const TetraMesh& coarse_;
    int levels_;
    std::array<TetraPattern, 3> patterns_;  ///< by diagonal
    Buffer<Parts> parts_;
    Buffer<Traits> traits_;
    Buffer<std::uint32_t> first_at_vertex_, at_vertex_;
    Buffer<std::uint32_t> first_edge_, first_face_;  ///< per vertex: of which it is the least vertex
    Buffer<float> shortest_at_;                      ///< vertices, edges, faces
    FineNumbers vertices_;
    std::uint32_t vertex_count_ = 0;
};

}  // namespace coppice
