#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/repair/crossings_internal.h"

// Compares the search for self-intersections by tube rows with the search over the whole mesh.

namespace coppice::test {

/// Quads before any of them are remeshed, and their tubes.
struct Quads {
    QuadSurface surface;
    Skeleton tubes;
    int levels;  ///< number of refinements of the cage
};

inline Quads make_quads(const Skeleton& skeleton, MeshOptions options) {
    options.remesh_rounds = 0;
    options.fit = Fit::surface;
    const Skeleton prepared = prepare(skeleton, options.prepare).skeleton;
    const bool merges = options.overlaps == Overlaps::merge && options.method == MeshMethod::quads;
    const GraftResult grafted =
        graft_branches(prepared, options.graft, merges ? SectionEnd::joined : SectionEnd::closed, {});
    Skeleton parted = separate_branches(grafted.tubes, grafted.joins, {}).skeleton;
    QuadSurface surface = std::move(mesh_skeleton(skeleton, options).quads());
    if (options.method == MeshMethod::quads) return {std::move(surface), std::move(parted), options.levels};
    RamificationMesh made =
        build_ramifications(parted, options.control, options.levels, options.ramification);
    return {std::move(surface), std::move(made.tubes), options.levels - 1};
}

inline std::vector<FacePair> search(const QuadMesh& mesh) {
    const PolygonMesh polygons = to_polygons(mesh);
    return crossing_faces(SurfaceTree(polygons), 1u << 20).pairs;
}

inline std::vector<FacePair> tube_row_search(const Quads& quads, const QuadMesh& mesh,
                                             const Context& ctx = {}) {
    const pipeline_internal::TubeRows tube_rows(quads.surface.cage, quads.tubes, quads.levels);
    return find_tube_crossings(mesh, tube_rows, ctx).pairs;
}

/// Returns the number of pairs.
inline std::size_t expect_same(const Skeleton& skeleton, const MeshOptions& options = {}) {
    const Quads quads = make_quads(skeleton, options);
    const std::vector<FacePair> all = search(quads.surface.mesh);
    EXPECT_EQ(tube_row_search(quads, quads.surface.mesh), all);
    return all.size();
}

}  // namespace coppice::test
