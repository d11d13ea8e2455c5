#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// Returns the first node of the branch that has approximately this number of segments: of all laterals, or
/// if there are none of all nodes except roots, the one with the closest number by ratio; of equals the
/// first. None for a skeleton without segments. O(n).
NodeId branch_of_about(const Skeleton& skeleton, std::uint32_t segments);

/// The positions of all inputs of a surface while a branch is dragged.
struct DragPose {
    double angle = 0;              ///< [rad] rotation of the branch from rest
    std::vector<Vec3> nodes;       ///< [m] of QuadBuild::skeleton
    std::vector<Vec3> tube_nodes;  ///< [m] of QuadBuild::tubes
    Buffer<Vec3> cage;             ///< [m] positions of the cage's vertices
    Buffer<Vec3> anchors;          ///< [m] their anchors
    std::vector<ClipPlane> clips;  ///< flat ends of the cage
};

/// A branch that rotates around its base, the node at which it begins, with everything that it carries.
///
/// Segments rotate rigidly. The cage keeps its quads: a vertex with only quads of rotating tubes rotates with
/// them, and so does its anchor; a vertex at the fork, which also has quads of tubes that do not rotate,
/// rotates by the share of the angle that equals the share of rotating quads. So no part shrinks, and a fork
/// is as smooth as the cage around it. Radii do not change.
class BranchDrag {
  public:
    /// `top` is a node of the build's skeleton, not a root; the axis has any length except 0. The build must
    /// outlive this object. O(n).
    BranchDrag(const QuadBuild& build, NodeId top, Vec3d axis);

    NodeId top() const { return top_; }                                         ///< first node of the branch
    Vec3d pivot() const { return pivot_; }                                      ///< [m] centre of rotation
    Vec3d axis() const { return axis_; }                                        ///< unit
    std::span<const std::uint32_t> nodes() const { return nodes_; }             ///< rotating nodes, ascending
    std::span<const std::uint32_t> tube_nodes() const { return tube_nodes_; }   ///< the same, of the tubes
    std::span<const std::uint32_t> cage_vertices() const { return vertices_; }  ///< the same, of the cage
    std::span<const float> shares() const {
        return shares_;
    }  ///< share of the angle, in (0, 1]; per rotating cage vertex

    /// Returns the pose at rest, bit-identical to the build.
    DragPose rest() const;
    /// Rotates the branch by an angle [rad] from rest, counter-clockwise seen against the axis. Writes only
    /// rotating elements, so that `pose` has to come from rest(); the result for angle 0 is bit-identical to
    /// it. O(branch).
    void turn(double angle, DragPose& pose) const;

  private:
    void find_shares(const std::vector<std::uint8_t>& turns);

    const QuadBuild* build_;
    NodeId top_;
    Vec3d pivot_, axis_;
    std::vector<std::uint32_t> nodes_, tube_nodes_, vertices_, clips_;
    std::vector<float> shares_;
};

}  // namespace coppice::bench
