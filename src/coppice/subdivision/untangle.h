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

/// When faces count as folded, and how long unfolding goes on.
struct UntangleOptions {
    int passes = 25;            ///< at most; 0 = off
    int projected_passes = 15;  ///< of these, the first so many return to the surface after smoothing
    float quality = 0.2f;       ///< a face is bad when its scaled Jacobian (mesh/shape.h) is less than this
};

template <class Self, class Visitor>
requires SameOptions<Self, UntangleOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"passes", "smoothing passes around folded faces at most, 0 leaves them as they are",
                Unit::none, 0, 1000},
          o.passes);
    visit(Field{"projected_passes", "of these, passes that return to the surface after smoothing", Unit::none,
                0, 1000},
          o.projected_passes);
    visit(Field{"quality", "scaled Jacobian below which a face counts as folded", Unit::none, 0, 0.9},
          o.quality);
}

/// The quads of a refined cage, whose vertices are to be moved.
struct RefinedQuads {
    std::span<Vec3> positions;      ///< one per refined vertex
    std::span<const Vec3> anchors;  ///< one per refined vertex
    std::span<const Quad> quads;    ///< PatchRefinement::quads()
};

/// What unfolding found and did, counted.
struct UntangleReport {
    std::uint64_t bad_before = 0;          ///< faces
    std::uint64_t bad_after = 0;           ///< faces that stayed bad
    std::uint32_t passes = 0;              ///< made, those taken back included
    std::uint64_t moved = 0;               ///< vertices that lie elsewhere than before
    std::vector<std::uint32_t> still_bad;  ///< faces that stayed bad, ascending
    friend bool operator==(const UntangleReport&, const UntangleReport&) = default;  ///< member by member
};

/// Unfolds the few faces that projection has folded, mostly in acute forks, without moving anything else.
///
/// A face is bad when the least sine of its corners is below `quality`, or when it looks inward: the cosine
/// of its normal to the way from its corners' anchors to its corners is below 0.05. Each pass takes the
/// corners of the bad faces and the two rings of faces around them, moves these vertices 0.6 of the way to
/// the mean of their neighbours, all at once, and back onto the surface value = level by up to three steps
/// along the gradient on value^(2/5), none longer than 0.3 of the distance to the anchor, in the region of
/// the vertex's owner as in project(). Vertices of flat ends keep to their planes, rims also to the surface;
/// where the field has no gradient a vertex stays where smoothing put it; boundaries stay. What is still
/// folded after `projected_passes` is smoothed without returning to the surface, at first the bad faces
/// alone, then with one and two rings: it unfolds like a soap film, at the price of some radius in a crevice.
/// Bad faces far from each other are clusters, which are unfolded each by itself: what becomes of one depends
/// on nothing beyond four rings of faces about it. A cluster ends when none of its faces is bad, when ten
/// passes that do not return to the surface brought no gain, or when each of its vertices has moved 25 times
/// on average; its state with the fewest bad faces is kept, the first of equals.
///
/// `target` as for project(). The first look at all faces is the cost of a
/// clean mesh, which keeps its bits; after that time and memory go with the number of bad faces, but for two
/// bits per vertex and one per quad. Deterministic for any number of threads. Throws InvalidInput when an
/// option is out of range or the sizes do not match.
UntangleReport untangle(const RefinedQuads& surface, const PatchRefinement& patches,
                        const ProjectionTarget& target, const UntangleOptions& options = {},
                        const Context& ctx = {});

}  // namespace coppice
