#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/project.h"

namespace coppice {

/// Criterion of folded faces, and limits of unfolding.
struct UntangleOptions {
    int passes = 25;            ///< maximum number; 0 = off
    int projected_passes = 15;  ///< number of the first passes, which return to the surface after smoothing
    float quality = 0.2f;       ///< a face is bad if its scaled Jacobian (mesh/shape.h) is less than this
};

/// Lists the members for front ends.
void list_fields(UntangleOptions& o, FieldList& list);

/// The quads of a refined cage with movable vertices.
struct RefinedQuads {
    std::span<Vec3> positions;      ///< one per refined vertex
    std::span<const Vec3> anchors;  ///< one per refined vertex
    std::span<const Quad> quads;    ///< PatchRefinement::quads()
};

/// Counts of the unfolding.
struct UntangleReport {
    std::uint64_t bad_before = 0;          ///< faces
    std::uint64_t bad_after = 0;           ///< faces that remained bad
    std::uint32_t passes = 0;              ///< including passes that were undone
    std::uint64_t moved = 0;               ///< vertices with a changed position
    std::vector<std::uint32_t> still_bad;  ///< faces that remained bad, ascending
    friend bool operator==(const UntangleReport&, const UntangleReport&) = default;  ///< memberwise
};

/// Unfolds the few faces that projection has folded, mostly in acute forks, without moving other vertices.
///
/// A face is bad if the minimum sine of its corners is below `quality`, or if it points inward: the cosine
/// between its normal and the direction from its corners' anchors to its corners is below 0.05. Each pass
/// moves the corners of the bad faces and of the two rings of faces around them by 0.6 of the distance to the
/// mean of their neighbours, all simultaneously, and back onto the surface value = level by up to three steps
/// along the gradient on value^(2/5), none longer than 0.3 of the distance to the anchor, in the region of
/// the vertex's owner as in project(). Vertices of flat ends stay in their planes, rims also on the surface;
/// where the field has no gradient a vertex keeps its smoothed position; boundaries do not move. Faces that
/// are still folded after `projected_passes` are smoothed without returning to the surface, first the bad
/// faces alone, then with one and two rings: they unfold like a soap film, at the cost of some radius in a
/// crevice. Distant bad faces form clusters, each of which is unfolded separately: the result for a cluster
/// depends only on the four rings of faces around it. A cluster ends if none of its faces is bad, if ten
/// passes that do not return to the surface made no improvement, or if each of its vertices has moved 25
/// times on average; its state with the minimum number of bad faces is kept, the first of equals.
///
/// `target` as for project(). The first check of all faces is the cost of a clean mesh, which is unchanged;
/// after that, time and memory are proportional to the number of bad faces, except for two bits per vertex
/// and one per quad. The result does not depend on the number of threads. Throws InvalidInput if an option is
/// out of range or the sizes do not match.
UntangleReport untangle(const RefinedQuads& surface, const PatchRefinement& patches,
                        const ProjectionTarget& target, const UntangleOptions& options = {},
                        const Context& ctx = {});

}  // namespace coppice
