#pragma once

#include <optional>
#include <span>

#include "coppice/render/render.h"
#include "coppice/scene/command.h"

namespace coppice {

/// Renderable geometry of several objects: solids as surfaces, points as small balls, paths as thin tubes.
/// Profiles cannot be drawn.
class Drawing {
  public:
    /// `point_radius` [m] is the radius of the balls; 0 = computed from the extent of the points. Throws
    /// InvalidInput for a profile, and if the memory left for the call is exceeded; Cancelled.
    Drawing(std::span<const ObjectPtr> objects, float point_radius, const SceneCall& call);

    /// Returns the input of render(); this object must outlive it.
    RenderScene scene() const {
        return {.mesh = mesh_ ? &*mesh_ : nullptr,
                .skeleton = skeleton_ ? &*skeleton_ : nullptr,
                .deviation = {}};
    }

  private:
    std::optional<PolygonMesh> mesh_;
    std::optional<Skeleton> skeleton_;
};

}  // namespace coppice
