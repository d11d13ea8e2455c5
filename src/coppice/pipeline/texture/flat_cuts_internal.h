#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/cage/cage.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/texture.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {

/// The flat ends of a surface, in the planes across the ends of its branches.
class FlatCuts {
  public:
    /// Finds the ends of a prepared skeleton. `origin`: [m] of the surface. O(n log n).
    FlatCuts(const Skeleton& prepared, const ControlOptions& ends, Vec3d origin, const Context& ctx);

    /// Returns the end that each face closes, kNoIndex for other faces. O(n log n).
    std::vector<std::uint32_t> find(const FaceView& mesh, const Context& ctx) const;
    /// Gives the faces that close ends the coordinates of a picture of a cut: its disc fills the unit square.
    /// `end_of_face`: the result of find(). O(n).
    void map(const FaceView& mesh, std::span<const std::uint32_t> end_of_face, Texture& texture) const;

  private:
    struct End {
        Vec3 center, normal;  // the normal is outward
        float radius;         // [m] of the skeleton
    };
    static std::vector<End> find_ends(const Skeleton& prepared, const ControlOptions& ends, Vec3d origin);
    static std::vector<Box3> make_boxes(std::span<const End> ends);
    bool closes(const End& end, const FaceView& mesh, std::uint32_t face) const;

    std::vector<End> ends_;
    BoxTree tree_;
};

}  // namespace coppice::pipeline_internal
