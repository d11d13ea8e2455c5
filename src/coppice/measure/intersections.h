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

/// Two faces that have a point in common beyond the corners and edges that they share; first < second.
struct FacePair {
    std::uint32_t first = 0;                                              ///< a face
    std::uint32_t second = 0;                                             ///< a later one
    friend auto operator<=>(const FacePair&, const FacePair&) = default;  ///< by first, then second
};

/// Faces that cross.
struct FacePairs {
    std::vector<FacePair> pairs;  ///< each once, in order
    bool complete = true;         ///< false when the search ended at its limit
};

/// All pairs of faces that cross or touch, decided exactly. Faces that share a vertex do so when an edge
/// opposite to it meets the other face; faces that share an edge when they fold onto each other; faces with
/// the same three corners always. O(n + boxes that overlap); polls ctx.stop. The search ends soon after
/// `limit` pairs, which keeps tangled soup from filling the memory.
FacePairs crossing_faces(const SurfaceTree& surface, std::uint32_t limit, const Context& ctx = {});

/// The pairs among some faces, given by their numbers, ascending and each once; pairs have these numbers too.
/// What it costs depends on those faces, but for a bit per vertex of the mesh.
FacePairs crossings_among(const FaceView& mesh, std::span<const std::uint32_t> faces, std::uint32_t limit,
                          const Context& ctx = {});

/// The faces whose boxes meet any of the boxes, which must not be empty; ascending. O(n) where few do.
std::vector<std::uint32_t> faces_near(const FaceView& mesh, std::span<const Box3> boxes,
                                      const Context& ctx = {});

/// Crossing pairs by the parts of the skeleton they belong to: the segments of least rho at the means of
/// their corners.
struct IntersectionReport {
    std::uint64_t total = 0;  ///< pairs
    std::uint64_t local =
        0;  ///< of neighbours along the skeleton: within three nodes, or within three radii of way
    std::uint64_t remote =
        0;  ///< of other parts whose capsules keep clear of each other by 5 % of their radii
    std::uint64_t overlap =
        0;                 ///< of other parts whose capsules overlap, which is a property of the skeleton
    bool complete = true;  ///< false when there are more pairs than the search was allowed to find
    /// member by member
    friend bool operator==(const IntersectionReport&, const IntersectionReport&) = default;
};

/// Sorts pairs by kind. All are local without a skeleton; `capsules` must be those of `skeleton`, in the
/// mesh's frame.
IntersectionReport classify(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                            const CapsuleTree* capsules, const Context& ctx = {});

/// A place where a surface crosses itself.
struct CrossingPlace {
    NodeId node;  ///< with a skeleton the node nearest to the place, of the segment that most pairs lie on
    NodeId other_node;        ///< the same of the other face of these pairs; often the same node
    Vec3d place;              ///< [m] the mean of the faces, with the mesh's origin
    double radius = 0;        ///< [m] from there to the farthest corner of them
    std::uint64_t pairs = 0;  ///< of faces
    friend bool operator==(const CrossingPlace&, const CrossingPlace&) = default;  ///< member by member
};

/// The places where a surface crosses itself.
struct CrossingPlaces {
    std::uint64_t total = 0;                                       ///< number of places
    std::vector<CrossingPlace> largest;                            ///< some of them, by number of pairs
    std::uint64_t more() const { return total - largest.size(); }  ///< places not named
    friend bool operator==(const CrossingPlaces&, const CrossingPlaces&) = default;  ///< member by member
};

/// Sorts pairs by place: two belong together when their faces share a vertex, and so on. The `most_named`
/// places with most pairs are described; of equal ones those of earlier faces come first. Nodes are named
/// with a skeleton only; `capsules` must be those of `skeleton`, in the mesh's frame. O(pairs), but for a
/// number per vertex and a search for each face of the places that are named.
CrossingPlaces crossing_places(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                               const CapsuleTree* capsules, std::size_t most_named, const Context& ctx = {});

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
