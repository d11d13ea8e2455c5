#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/render/colors.h"
#include "coppice/render/render.h"
#include "coppice/render/trace/camera_internal.h"
#include "coppice/render/trace/embree_internal.h"
#include "coppice/render/trace/traced_copies_internal.h"
#include "coppice/render/trace/traced_mesh_internal.h"

namespace coppice {

/// The intersection of a ray with the object.
struct Hit {
    Vec3 position;
    Vec3 normal;            ///< unit, smoothed, on the side of the ray's origin
    Vec3 geometric_normal;  ///< unit, of the face, on the same side
    /// Start of secondary rays: on a smoothed mesh above the face, near the smooth surface. If they started
    /// on the face, faces at grazing light would be entirely black.
    Vec3 lifted;
    float distance = 0;
    std::optional<std::uint32_t> point;  ///< index of the drawn point, if on one
    std::optional<std::uint32_t> node;   ///< of the skeleton, if on its segment or ball
    std::optional<std::uint32_t> copy;   ///< of a prototype, if on one
    bool on_mesh = false;
    FacePlace place;  ///< on the mesh, or on the prototype of the copy
};

/// The object for rays, moved to the origin and scaled so that the diagonal of its box is 1.
class TracedScene {
  public:
    TracedScene(const RenderScene& scene, const RenderOptions& options, const Context& ctx);

    std::optional<Hit> trace(Vec3 origin, Vec3 direction) const;
    std::optional<Hit> trace_axis(Vec3 origin,
                                  Vec3 direction) const;  ///< intersects only the skeleton inside a mesh
    std::optional<Hit> trace_marked(Vec3 origin, Vec3 direction) const;  ///< intersects only the marked faces
    bool occluded(Vec3 origin, Vec3 direction, float far) const;

    const std::vector<FramePoint>& frame_points() const { return frame_points_; }
    Box3 bounds() const { return bounds_; }
    bool has_axis() const { return axis_ != nullptr; }
    bool has_marked() const { return marked_ != nullptr; }
    bool has_point_colors() const { return !point_colors_.empty(); }
    /// linear, of a drawn point
    std::optional<Vec3> point_color(std::uint32_t point) const {
        return has_point_colors() ? std::optional(to_linear(point_colors_[drawn_point(point)]))
                                  : std::nullopt;
    }
    bool measures_mesh() const { return point_count_ == 0; }  ///< false if points are measured
    Vec3 local(Vec3d world) const { return Vec3((world - center_) * scale_); }
    SketchView local(SketchView view) const;  ///< the view in the coordinates of the scene
    float local_length(double length) const { return static_cast<float>(length * scale_); }

    const TracedMesh& mesh() const { return mesh_; }
    float deviation(const Hit& hit) const;  ///< NaN where unknown
    float evidence(std::uint32_t node) const { return evidence_[node]; }
    double distance_to_other(const Hit& hit) const;  ///< [m] signed, from the other surface
    /// Returns the texture coordinates and the material of a hit on the mesh or on a copy; nullopt without
    /// materials. The materials of copies follow those of the mesh.
    std::optional<TexturePlaces> texture_places(const Hit& hit) const;
    Vec3 copy_color(std::uint32_t copy) const { return to_linear(copies_->color(copy)); }  ///< linear
    /// Returns the colour that the scene specifies for a vertex or a node, linear; nullopt if it has none.
    std::optional<Vec3> object_color(const Hit& hit) const;

  private:
    void place(const RenderScene& scene, float skeleton_width, const Context& ctx);
    void build_mesh(const RenderScene& scene, bool flat, const Context& ctx);
    void build_copies(const RenderScene& scene, bool flat, const Context& ctx);
    void collect_frame_points(const RenderScene& scene, float skeleton_width);
    void collect_frame_balls(const RenderScene& scene);
    void attach_points(RTCScene scene, const RenderScene& of);
    /// Returns the index in the cloud of a drawn point.
    std::size_t drawn_point(std::size_t k) const { return k * cloud_size_ / point_count_; }
    void attach_tubes(RTCScene scene, const Skeleton& skeleton, float width);
    std::optional<Hit> trace(RTCScene scene, Vec3 origin, Vec3 direction) const;
    void smooth(Hit& hit) const;
    Vec3 local(Vec3 p, Vec3d origin) const { return Vec3((Vec3d(p) + (origin - center_)) * scale_); }

    Vec3d center_;
    double scale_ = 1;
    Box3 bounds_;
    std::vector<FramePoint> frame_points_;
    TracedMesh mesh_;
    std::unique_ptr<TracedCopies> copies_;  ///< null if there are none
    std::uint32_t mesh_material_count_ = 0;
    std::span<const float> deviation_, evidence_;
    const SurfaceTree* distance_to_ = nullptr;
    std::span<const Rgb> point_colors_, node_colors_;
    std::vector<Vec3> vertex_colors_;               ///< linear; empty if there are none
    std::size_t cloud_size_ = 0, point_count_ = 0;  ///< number of all points, and of the drawn ones
    /// Contents of the solid scene, in the order of Embree's ids.
    enum class GeometryKind : std::uint8_t { mesh, points, tubes, copies };
    std::vector<GeometryKind> kinds_;
    std::vector<std::vector<std::uint32_t>>
        tube_nodes_;  ///< for each geometry of tubes: nodes of its elements
    EmbreeDevice device_;
    EmbreeScene solid_, axis_, marked_;
};

}  // namespace coppice
