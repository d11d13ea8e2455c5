#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/implicit/field_ref.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/held_internal.h"
#include "coppice/tetra/march/kernel/profile_kernel.h"
#include "coppice/tetra/march/ranked_bits_internal.h"
#include "coppice/tetra/march/samples_view.h"

namespace coppice::tetra_internal {

/// Points asked of the field at once.
inline constexpr std::size_t kBatch = 512;

using tetra_kernel::Profile;
using tetra_kernel::WeakVertex;

/// What is known of every fine vertex. A vertex that lies on the surface counts as outside.
struct Samples {
    Buffer<float> height;  ///< of the profile; -1 for vertices of no tetrahedron
    RankedBits above;      ///< those whose height is above 0
    RankedBits inside;
    RankedBits held;               ///< inside whatever the field says, and never on the surface
    RankedBits on;                 ///< moved onto the surface and not put back
    RankedBits moved;              ///< these, and held ones moved towards their axis and not put back
    RankedBits placed;             ///< all that were near enough, and held ones that were moved; ranked
    Buffer<Vec3> place;            ///< [m] by rank in `placed`: where they were moved
    Buffer<float> way;             ///< [m] by rank in `placed`: how far they were moved
    std::vector<WeakVertex> weak;  ///< ascending

    /// Puts a vertex back to where it was.
    void put_back(std::uint32_t vertex) {
        on.reset(vertex);
        moved.reset(vertex);
        if (above.test(vertex) || held.test(vertex)) inside.set(vertex);
    }

    /// As spans, which end with this.
    tetra_kernel::SamplesView view() const {
        return {height,
                {inside.words()},
                {on.words()},
                {held.words()},
                {moved.words()},
                placed.view(),
                place,
                way,
                weak};
    }
};

/// Samples the fine vertices, and finds where those near the surface would come to lie on it. Moves held ones
/// towards their axis where they are near the surface or outside. `on` is that of all that were near enough.
Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap,
                        const HeldVertices& held, std::span<const Segment> axes, const Context& ctx);

/// Hull faces with vertices on both sides, ascending; and if wanted those that are inside as a whole.
std::vector<TetraFace> open_faces(const TetraRefinement& refinement, const RankedBits& inside,
                                  bool with_inner, const Context& ctx);

}  // namespace coppice::tetra_internal
