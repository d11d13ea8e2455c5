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

/// Number of points in one query of the field.
inline constexpr std::size_t kBatch = 512;

using tetra_kernel::Profile;
using tetra_kernel::WeakVertex;

/// Properties of every fine vertex. A vertex on the surface counts as outside.
struct Samples {
    Buffer<float> height;  ///< height of the profile; -1 for vertices without tetrahedra
    RankedBits above;      ///< vertices with a height above 0
    RankedBits inside;
    RankedBits held;               ///< inside for any field, and never on the surface
    RankedBits on;                 ///< moved onto the surface and not moved back
    RankedBits moved;              ///< these, and held vertices moved towards their axis and not moved back
    RankedBits placed;             ///< all that were close enough, and held vertices that were moved; ranked
    Buffer<Vec3> place;            ///< [m] by rank in `placed`: moved position
    Buffer<float> way;             ///< [m] by rank in `placed`: distance of the move
    std::vector<WeakVertex> weak;  ///< ascending

    /// Moves a vertex back to its original position.
    void put_back(std::uint32_t vertex) {
        on.reset(vertex);
        moved.reset(vertex);
        if (above.test(vertex) || held.test(vertex)) inside.set(vertex);
    }

    /// Returns spans.
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

/// Samples the fine vertices, and computes the positions on the surface of those near it. Moves held vertices
/// towards their axis if they are near the surface or outside. `on` contains all vertices that were close
/// enough.
Samples sample_vertices(const TetraRefinement& refinement, FieldRef field, float snap,
                        const HeldVertices& held, std::span<const Segment> axes, const Context& ctx);

/// Returns hull faces with vertices on both sides, ascending; with `with_inner` also those that are entirely
/// inside.
std::vector<TetraFace> open_faces(const TetraRefinement& refinement, const RankedBits& inside,
                                  bool with_inner, const Context& ctx);

}  // namespace coppice::tetra_internal
