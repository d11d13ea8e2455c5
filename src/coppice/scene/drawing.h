#pragma once

#include <optional>
#include <span>

#include "coppice/render/render.h"
#include "coppice/scene/command.h"

namespace coppice {

/// What a picture of several objects shows: solids as their surfaces, points as small balls, paths as thin
/// tubes. Profiles cannot be drawn.
class Drawing {
  public:
    /// `point_radius` [m] is that of the balls; 0 = by the size of the points. Throws InvalidInput for a
    /// profile, and for more memory than the call has left; Cancelled.
    Drawing(std::span<const ObjectPtr> objects, float point_radius, const SceneCall& call);

    /// What render() draws; this must outlive it.
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
