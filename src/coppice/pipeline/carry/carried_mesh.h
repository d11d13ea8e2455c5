#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/animate/pose.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/subdivision/project.h"

namespace coppice {

/// The surface of a skeleton in another pose.
struct CarriedFrame {
    Buffer<Vec3> positions;             ///< [m] by vertex of the rest pose's mesh
    std::vector<std::uint32_t> folded;  ///< faces whose scaled Jacobian is not above 0, as none was at rest
    std::vector<FacePair> crossings;    ///< pairs of faces that cross, and did not at rest
    ProjectReport projected;            ///< how near the field's level the vertices are

    bool is_sound() const { return folded.empty() && crossings.empty(); }  ///< no worse than at rest
};

/// One surface of quads for all poses of a skeleton: made once, at rest, remeshed knots included, and carried
/// by the segments [Zhu2015], section 6. Its faces never change.
///
/// Every vertex has an anchor on the axes and moves with up to four segments: the anchor with their moves,
/// and the way from there to the vertex with their turns, blended over joints along the axis and where a
/// lateral leaves its host. Then the vertices go along these ways onto the field of the posed skeleton.
/// Vertices that did not lie on the field at rest, on flat ends, in remeshed knots, or where folds were
/// smoothed away, are carried alone.
///
/// Some 60 bytes per vertex above the surface itself.
class CarriedMesh {
  public:
    /// Throws what mesh_skeleton() throws, and InvalidInput naming `method` or `weights` where they are not
    /// quads and local.
    CarriedMesh(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});
    ~CarriedMesh();                                  ///< gives its memory back
    CarriedMesh(CarriedMesh&&) noexcept;             ///< takes over
    CarriedMesh& operator=(CarriedMesh&&) noexcept;  ///< takes over

    const MeshResult& made() const;    ///< the surface at rest, and how it was made
    const Skeleton& skeleton() const;  ///< at rest

    /// The surface in a pose of that skeleton; the rest pose gives the surface at rest to the bit. The
    /// vertices of `stiff`, ascending, are carried alone. The same bits for any number of threads. O(n log
    /// n).
    CarriedFrame carry(const Pose& pose, std::span<const std::uint32_t> stiff = {}, const Context& ctx = {});

    /// The vertices of the faces that are at fault in a frame, and of all faces about them, ascending.
    std::vector<std::uint32_t> at_fault(const CarriedFrame& frame) const;

    /// Marks the nodes of the skeleton whose segments move a face; of one that was remeshed, all those that
    /// move the piece that was remeshed together, which is one body.
    void mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const;
    /// The node of the skeleton whose segment moves a face most.
    NodeId mover(std::uint32_t face) const;

  private:
    class Body;
    std::unique_ptr<Body> body_;
};

}  // namespace coppice
