#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The first node of the branch that has about so many segments: of all laterals, or where there are none of
/// all nodes but roots, that whose number is the nearest by ratio; of equals the first. None for a skeleton
/// without segments. O(n).
NodeId branch_of_about(const Skeleton& skeleton, std::uint32_t segments);

/// Where everything is that a surface is made of, while a branch is dragged.
struct DragPose {
    double angle = 0;              ///< [rad] that the branch has turned from rest
    std::vector<Vec3> nodes;       ///< [m] of QuadModel::skeleton
    std::vector<Vec3> tube_nodes;  ///< [m] of QuadModel::tubes
    Buffer<Vec3> cage;             ///< [m] positions of the cage's vertices
    Buffer<Vec3> anchors;          ///< [m] theirs
    std::vector<ClipPlane> clips;  ///< those of the cage
};

/// A branch that turns about its foot, the node that it leaves from, with all that hangs on it.
///
/// Segments turn exactly. The cage keeps its quads: a vertex whose quads are all of tubes that turn, turns
/// with them, and so does its anchor; one at the fork, which some of its quads share with tubes that stay,
/// turns by that part of the angle that these are of all its quads. So nothing shrinks, and a fork is as
/// smooth as the cage about it. Radii stay.
class BranchDrag {
  public:
    /// `top` is a node of the model's skeleton, no root; the axis has any length but 0. The model must
    /// outlive this. O(n).
    BranchDrag(const QuadModel& model, NodeId top, Vec3d axis);

    NodeId top() const { return top_; }                                         ///< first node of the branch
    Vec3d foot() const { return foot_; }                                        ///< [m] what it turns about
    Vec3d axis() const { return axis_; }                                        ///< unit
    std::span<const std::uint32_t> nodes() const { return nodes_; }             ///< that turn, ascending
    std::span<const std::uint32_t> tube_nodes() const { return tube_nodes_; }   ///< likewise, of the tubes
    std::span<const std::uint32_t> cage_vertices() const { return vertices_; }  ///< likewise, of the cage
    std::span<const float> shares() const {
        return shares_;
    }  ///< of the angle, in (0, 1]; per cage vertex
       ///< that turns

    /// Everything at rest: to the bit what the model has.
    DragPose rest() const;
    /// Turns the branch by an angle [rad] from rest, counter-clockwise seen against the axis. Writes only
    /// what turns, so that `pose` has to come from rest(); angle 0 gives the same bits as that. O(branch).
    void turn(double angle, DragPose& pose) const;

  private:
    void find_shares(const std::vector<std::uint8_t>& turns);

    const QuadModel* model_;
    NodeId top_;
    Vec3d foot_, axis_;
    std::vector<std::uint32_t> nodes_, tube_nodes_, vertices_, clips_;
    std::vector<float> shares_;
};

}  // namespace coppice
