#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/mesh.h"
#include "coppice/mesh/solid_mesh.h"
#include "coppice/tetra/march/crossed_internal.h"
#include "coppice/tetra/march/kernel/fan_kernel.h"

namespace coppice::tetra_internal {

using tetra_kernel::Fan;
using tetra_kernel::judge_fan;
using tetra_kernel::LinkSegment;
using tetra_kernel::ListedFan;

/// Returns the fans of all vertices on the surface, by rank in `placed`; fans that may be non-manifold remain
/// unknown. O(triangles).
std::vector<Fan> find_fans(const TetraRefinement& refinement, const Samples& samples,
                           const CrossedTetra& crossed, const Context& ctx);

/// Returns the vertices to move back because fine tetrahedra, of all coarse ones or of the given ones, were
/// inverted or became too flat: for each the vertex that moved farthest. Ascending.
std::vector<std::uint32_t> find_folds(const TetraRefinement& refinement, const Samples& samples,
                                      const Context& ctx);
std::vector<std::uint32_t> find_folds(const TetraRefinement& refinement, const Samples& samples,
                                      std::span<const std::uint32_t> tetra, const Context& ctx);

/// Returns the numbers below `universe` that body(range, mark) marks by calling mark(number), over ranges of
/// [0, count): ascending and unique. Additional cost O(universe / 64).
template <class Body>
std::vector<std::uint32_t> collect_marked(std::size_t universe, std::size_t count, std::size_t grain,
                                          const Body& body, const Context& ctx) {
    std::vector<std::uint64_t> words(universe / 64 + 1);
    const auto mark = [&](std::uint32_t i) {
        std::atomic_ref(words[i / 64]).fetch_or(std::uint64_t{1} << (i % 64), std::memory_order_relaxed);
    };
    parallel_for_ranges(ctx, count, grain, [&](IndexRange range) { body(range, mark); });
    std::vector<std::uint32_t> out;
    for_each_bit(words, [&](std::uint32_t i) { out.push_back(i); });
    return out;
}

/// Result of moving vertices back.
struct SnappedVertices {
    CrossedTetra crossed;
    std::vector<std::uint8_t> used;  ///< by rank in `placed`: whether a vertex on the surface has triangles
};

/// Moves vertices back until no fine tetrahedron is inverted or flat, and the triangles around each vertex on
/// the surface form one closed fan, or there are no triangles. The result refers to `refinement` and
/// `samples`.
SnappedVertices unsnap_vertices(const TetraRefinement& refinement, Samples& samples, const Context& ctx);

/// The surface, and the number of fine tetrahedra that it crosses.
struct ExtractedSurface {
    TriMesh mesh;
    SolidMesh solid;  ///< the same vertices, and those inside; empty if not requested
    std::uint64_t crossed = 0;
};

/// Creates triangles from the signs after all vertices were moved back, and with `with_solid` the tetrahedra
/// inside.
ExtractedSurface extract(const TetraRefinement& refinement, FieldRef field, const Samples& samples,
                         const SnappedVertices& snapped, int refinements, bool with_solid,
                         const Context& ctx);

}  // namespace coppice::tetra_internal
