#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/face_view.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Two faces that have a point in common other than the corners and edges that they share; first < second.
struct FacePair {
    std::uint32_t first = 0;                                              ///< a face
    std::uint32_t second = 0;                                             ///< a face of greater index
    friend auto operator<=>(const FacePair&, const FacePair&) = default;  ///< by first, then second
};

/// The faces that intersect.
struct FacePairs {
    std::vector<FacePair> pairs;  ///< each once, sorted
    bool complete = true;         ///< false if the search stopped at its limit
};

/// Returns all pairs of faces that intersect or touch, decided exactly. Faces that share a vertex intersect
/// if an edge opposite to it meets the other face; faces that share an edge if they fold onto each other;
/// faces with the same three corners always. O(n + overlapping boxes); polls ctx.stop. The search stops soon
/// after `limit` pairs, so that a tangled mesh cannot exhaust the memory.
FacePairs crossing_faces(const SurfaceTree& surface, std::uint32_t limit, const Context& ctx = {});

/// Returns the pairs among some faces, given by their indices, sorted and each once; the pairs contain the
/// same indices. The cost depends on the number of those faces, except for one bit per vertex of the mesh.
FacePairs crossings_among(const FaceView& mesh, std::span<const std::uint32_t> faces, std::uint32_t limit,
                          const Context& ctx = {});

/// Returns the faces with boxes that meet any of `boxes`, which must not be empty; sorted. O(n) if few do.
std::vector<std::uint32_t> faces_near(const FaceView& mesh, std::span<const Box3> boxes,
                                      const Context& ctx = {});

/// Numbers of intersecting pairs by their relation along the skeleton: each face belongs to the segment with
/// the smallest rho at the mean of its corners.
struct IntersectionReport {
    std::uint64_t total = 0;  ///< number of pairs
    /// Of neighbours along the skeleton: within three nodes, or within a path length of three radii.
    std::uint64_t local = 0;
    /// Of other sections with capsules that are apart by at least 5 % of their radii.
    std::uint64_t remote = 0;
    /// Of other sections with overlapping capsules, which is a property of the skeleton.
    std::uint64_t overlap = 0;
    bool complete = true;  ///< false if there are more pairs than the limit of the search
    /// member by member
    friend bool operator==(const IntersectionReport&, const IntersectionReport&) = default;
};

/// Counts pairs by kind. All are local without a skeleton; `capsules` must be the capsules of `skeleton`, in
/// the mesh's frame.
IntersectionReport classify(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                            const CapsuleTree* capsules, const Context& ctx = {});

/// A place where a surface intersects itself.
struct CrossingPlace {
    /// With a skeleton: the node nearest to the place, of the segment to which most pairs belong.
    NodeId node;
    NodeId other_node;        ///< the same for the other face of these pairs; often the same node
    Vec3d place;              ///< [m] mean of the faces, with the mesh's origin
    double radius = 0;        ///< [m] from there to the farthest corner of the faces
    std::uint64_t pairs = 0;  ///< number of pairs of faces
    friend bool operator==(const CrossingPlace&, const CrossingPlace&) = default;  ///< member by member
};

/// The places where a surface intersects itself.
struct CrossingPlaces {
    std::uint64_t total = 0;             ///< number of places
    std::vector<CrossingPlace> largest;  ///< the places with most pairs, in decreasing order
    std::uint64_t more() const { return total - largest.size(); }  ///< number of places that are not listed
    friend bool operator==(const CrossingPlaces&, const CrossingPlaces&) = default;  ///< member by member
};

/// Groups pairs by place: pairs with faces that share a vertex, directly or through other pairs, belong
/// together. The `max_named` places with most pairs are described; of equal ones those of earlier faces are
/// first. Nodes require a skeleton; `capsules` must be the capsules of `skeleton`, in the mesh's frame.
/// O(pairs), plus a number per vertex and a search for each face of the described places.
CrossingPlaces crossing_places(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                               const CapsuleTree* capsules, std::size_t max_named, const Context& ctx = {});

/// Calls visit(name, number) for every figure, in order.
template <class Visitor>
void visit_figures(const CrossingPlace& p, Visitor&& visit) {
    visit("pairs", p.pairs);
    if (p.node) {
        visit("node", p.node.index());
        visit("other_node", p.other_node.index());
    }
    visit("x", p.place.x);
    visit("y", p.place.y);
    visit("z", p.place.z);
    visit("radius", p.radius);
}

/// Calls visit(name, number) for both counts.
template <class Visitor>
void visit_figures(const CrossingPlaces& p, Visitor&& visit) {
    visit("total", p.total);
    visit("more", p.more());
}

/// Calls visit(name, number) for every count.
template <class Visitor>
void visit_figures(const IntersectionReport& r, Visitor&& visit) {
    visit("total", r.total);
    visit("local", r.local);
    visit("remote", r.remote);
    visit("overlap", r.overlap);
    if (!r.complete) visit("complete", r.complete);
}

}  // namespace coppice
