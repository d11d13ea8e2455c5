#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/instances.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_cloud.h"
#include "coppice/render/frame_view.h"
#include "coppice/render/image.h"
#include "coppice/render/material.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// The quantity that the colour of a surface represents.
enum class RenderColor {
    plain,      ///< clay
    signal,     ///< magenta, which occurs neither in bark nor leaves nor sky
    deviation,  ///< see RenderScene
    distance,   ///< see RenderScene
    evidence,   ///< see RenderScene
    radius,     ///< radius of the skeleton, or of its segment that is closest to the mesh, by `radius_colors`
    order,      ///< branch order of the vertices of the mesh
    branch,     ///< number of the branch of the vertices of the mesh
    along,      ///< distance of the vertices of the mesh from the beginning of their branch
};

template <>
struct EnumNames<RenderColor> {
    static constexpr std::array<std::string_view, 9> names{
        "plain", "signal", "deviation", "distance", "evidence", "radius", "order", "branch", "along"};
};

/// A position to highlight.
struct RenderMark {
    Vec3d place;        ///< [m] in the world, including the origin
    double radius = 0;  ///< [m] extent of the highlighted object
};

/// The objects to draw; refers to values that must outlive the call.
///
/// A mesh alone is drawn as a solid, points as balls (of more than four million points an evenly spaced
/// selection of that number), a skeleton alone as round cones with its radii; together with either of the
/// others its axis is visible through them. Points with colours are drawn on a pale mesh. Marked faces are
/// drawn in magenta on a pale mesh, and are visible through occluding faces. All origins are taken into
/// account.
struct RenderScene {
    const PolygonMesh* mesh = nullptr;  ///< the surface; may be null
    /// Materials of the mesh, which require texture coordinates; drawn with the colour `plain`. May be empty.
    std::span<const RenderMaterial> materials;
    /// The index in `materials` of each face; faces with another value have no material. Empty: all faces
    /// have the first material.
    std::span<const std::uint32_t> face_materials;
    /// Placed copies, such as leaves, drawn on both sides and only with the colours `plain` and `signal`; may
    /// be null.
    const Instances* instances = nullptr;
    std::span<const Prototype> prototypes;  ///< of the copies
    /// Indexed by `Prototype::material`; prototypes with another value have no material.
    std::span<const RenderMaterial> prototype_materials;
    const PointCloud* cloud = nullptr;   ///< points; may be null
    float point_radius = 0;              ///< [m] of the points; > 0
    const Skeleton* skeleton = nullptr;  ///< the skeleton; may be null
    std::span<const float>
        deviation;  ///< per mesh vertex: distance outside the true surface / radius; NaN = unknown
    /// Per mesh vertex, for the colours `order`, `branch` and `along` [m], and for `radius` [m] in place of
    /// the skeleton; NaN = unknown.
    std::span<const float> vertex_values;
    std::span<const float>
        evidence;  ///< per node of the skeleton: fraction of its radius based on measurements, 0 to 1
    std::span<const Rgb> mesh_colors;      ///< per vertex of the mesh, for the colour `plain`; may be empty
    std::span<const Rgb> skeleton_colors;  ///< per node of the skeleton, for the colour `plain`; may be empty
    std::span<const std::uint32_t> marked_faces;  ///< of the mesh
    std::span<const RenderMark> marks;  ///< positions of rings, which are drawn large enough to be visible
    /// Another surface, from which distances are measured: of points without distances of their own, or of
    /// the mesh if there are no points.
    const SurfaceTree* distance_to = nullptr;
    const SketchView* view = nullptr;  ///< the camera; null: it frames the object
    /// [m] in the world: points that the camera frames in place of the object, as in the frames of an
    /// animation. The ground is at the height of the lowest.
    std::span<const Vec3d> framed;
};

/// Options of the rendering.
struct RenderOptions {
    CameraOptions camera;  ///< size of the image and placement of the camera; listed without a group
    int samples = 16;      ///< per pixel; noise decreases with the square root
    std::optional<Vec3d>
        look_at;     ///< [m] world: point at the centre of the image; by default the centre of the object
    float zoom = 1;  ///< magnification at the same position of the camera
    float sun_azimuth = -0.9f;    ///< [rad] from the direction of the camera to the sun, counter-clockwise
    float sun_elevation = 0.85f;  ///< [rad] of the sun above the horizon
    /// `deviation`, `distance` and `evidence` require those of RenderScene, `radius` a skeleton or
    /// `vertex_values`, as `order`, `branch` and `along` do; `plain` points have their own colours.
    RenderColor color = RenderColor::plain;
    float deviation_range = 0.1f;  ///< [radius] deviation of the full colour
    /// [m] distance of the full colour; 0 = 98 % quantile over the vertices or points
    float distance_range = 0;
    bool wireframe = false;    ///< draws the edges of the faces
    float wire_width = 1.0f;   ///< [pixels]
    bool flat = false;         ///< shows faces without smoothed normals
    bool ground = true;        ///< draws a ground that receives the shadow
    bool transparent = false;  ///< omits the background
    float axis_width = 0.15f;  ///< [radius] of the skeleton where it is visible through a mesh
};

/// Lists the members for front ends.
void list_fields(RenderOptions& o, FieldList& list);

/// Draws the scene with sun and sky light [Wald2014]. `distance` shows for every point of the mesh, or of the
/// cloud, how far outside the other surface it is, as in figure 10 of [Zhu2015]; it requires one search for
/// each sample, or point. The result does not depend on the number of threads; the time is that of building a
/// tree over the faces and copies (about n log n) plus that of up to three rays per sample. Copies share the
/// tree of their prototype: 500,000 of them take about 70 MiB. Throws InvalidInput for an empty scene,
/// options out of range, more than 128 million pixels, positions that are not finite, invalid instances, or a
/// look_at behind the camera; Cancelled if stopped.
Image render(const RenderScene& scene, const RenderOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
