#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/render/render.h"
#include "coppice/scene/command.h"

namespace coppice {

/// Renderable geometry of several objects: solids as surfaces, meshes with their materials and leaves, points
/// as small balls, paths as thin tubes. Profiles cannot be drawn.
class Drawing {
  public:
    /// `point_radius` [m] is the radius of the balls; 0 = computed from the extent of the points. Throws
    /// InvalidInput for a profile, and if the memory left for the call is exceeded; IoError for an image of a
    /// material that cannot be read; Cancelled.
    Drawing(std::span<const ObjectPtr> objects, float point_radius, const SceneCall& call);

    /// Returns the input of render(); this object must outlive it.
    RenderScene scene() const {
        return {.mesh = mesh_ ? &*mesh_ : nullptr,
                .materials = materials_,
                .face_materials = face_materials_,
                .instances = leaves_.empty() ? nullptr : &leaves_,
                .prototypes = prototypes_,
                .prototype_materials = leaf_materials_,
                .skeleton = skeleton_ ? &*skeleton_ : nullptr,
                .deviation = {}};
    }

  private:
    void load_materials(std::span<const SurfaceMaterial> materials, const SceneCall& call,
                        const Context& ctx);

    std::optional<PolygonMesh> mesh_;
    std::optional<Skeleton> skeleton_;
    std::vector<std::uint32_t> face_materials_;  ///< empty without materials
    std::vector<RenderMaterial> materials_;
    Instances leaves_;
    std::vector<Prototype> prototypes_;
    std::vector<RenderMaterial> leaf_materials_;
};

}  // namespace coppice
