#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// The refined quads of a surface that remeshing kept: rows around tubes, of which very few require a search
/// for crossings, for any vertex positions (see unproved_quads).
class KeptQuads {
  public:
    /// The build must outlive this object. O(n).
    KeptQuads(const QuadBuild& build, const Context& ctx);

    /// Returns the pairs of faces that cross after vertices of the remeshed mesh have been moved: the result
    /// of crossing_faces(), with the same limit. `tubes`: those of the build, moved like the vertices; wrong
    /// positions only cost time. O(n), except for remeshed quads and their neighbourhood.
    FacePairs crossings(const PolygonMesh& moved, const Skeleton& tubes, std::uint32_t limit,
                        const Context& ctx);

    /// Returns the refined vertices that the remeshed mesh begins with, ascending.
    std::span<const std::uint32_t> vertices() const { return vertices_; }

  private:
    const QuadBuild* build_;
    QuadMesh rows_;  ///< the refined quads; kept vertices are moved
    std::vector<std::uint32_t> vertices_;
    std::vector<std::uint32_t> quads_;  ///< per kept quad its refined one, ascending
};

}  // namespace coppice::pipeline_internal
