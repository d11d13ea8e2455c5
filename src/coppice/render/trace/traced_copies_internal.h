#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/mesh/instances.h"
#include "coppice/render/material.h"
#include "coppice/render/trace/traced_mesh_internal.h"

namespace coppice {

/// Placed copies of prototypes for rays: one Embree geometry, of which each element is a copy. It transforms
/// each ray into the frame of the prototype, and traces it there; of 500,000 copies this takes a quarter of
/// the memory of Embree's own instances and is faster. Refers to the prototypes, materials and instances.
class TracedCopies {
  public:
    /// Builds the tree of each prototype. `positions` are those of the copies in the coordinates of the
    /// scene, `unit` is the length of one metre there. Throws as `commit_scene`.
    TracedCopies(std::span<const Prototype> prototypes, std::span<const RenderMaterial> materials,
                 const Instances& instances, std::span<const Vec3> positions, float unit, bool flat,
                 RTCDevice device, const Context& ctx);
    TracedCopies(const TracedCopies&) = delete;
    TracedCopies& operator=(const TracedCopies&) = delete;
    ~TracedCopies() = default;

    /// Adds the copies to a scene. A hit has the number of the copy as `instID[0]`; all its other values
    /// refer to the prototype.
    void attach(RTCScene scene, RTCDevice device) const;

    const TracedMesh& prototype(std::uint32_t copy) const { return meshes_[places_[copy].prototype]; }
    /// Turns a direction from the frame of the prototype to that of the scene.
    Vec3 turned(std::uint32_t copy, Vec3 direction) const {
        return rotate(places_[copy].rotation, direction);
    }
    /// Returns the texture coordinates and the material of a place on a copy.
    TexturePlaces texture_places(std::uint32_t copy, const FacePlace& place) const;
    std::array<std::uint8_t, 3> color(std::uint32_t copy) const { return instances_.colors[copy]; }  ///< sRGB

  private:
    static void find_box(const RTCBoundsFunctionArguments* args);
    static void intersect(const RTCIntersectFunctionNArguments* args);
    static void occlude(const RTCOccludedFunctionNArguments* args);

    /// Everything that a ray needs of a copy, together for the caches.
    struct Place {
        Vec3 position;  ///< in the coordinates of the scene
        float scale;    ///< length of one metre of the prototype there
        Quaternion rotation;
        std::uint32_t prototype;
    };
    /// Replaces the ray by its image in the frame of the prototype, where its distances are the same. Returns
    /// whether it meets the box of the prototype.
    bool localize(RTCRay& ray, const Place& place) const;

    const Instances& instances_;
    std::vector<Place> places_;
    std::vector<TracedMesh> meshes_;
    std::vector<Box3> boxes_;  ///< of the prototypes, slightly enlarged
    std::vector<EmbreeScene> scenes_;
};

}  // namespace coppice
