#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_cloud.h"
#include "coppice/render/image.h"
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
};

template <>
struct EnumNames<RenderColor> {
    static constexpr std::array<std::string_view, 5> names{"plain", "signal", "deviation", "distance",
                                                           "evidence"};
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
    const PolygonMesh* mesh = nullptr;   ///< the surface; may be null
    const PointCloud* cloud = nullptr;   ///< points; may be null
    float point_radius = 0;              ///< [m] of the points; > 0
    const Skeleton* skeleton = nullptr;  ///< the skeleton; may be null
    std::span<const float>
        deviation;  ///< per mesh vertex: distance outside the true surface / radius; NaN = unknown
    std::span<const float>
        evidence;  ///< per node of the skeleton: fraction of its radius based on measurements, 0 to 1
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

/// Options of the rendering. The camera is placed so that the whole object just fits into the image.
struct RenderOptions {
    int width = 1024;            ///< [pixels]
    int height = 1024;           ///< [pixels]
    int samples = 16;            ///< per pixel; noise decreases with the square root
    float azimuth = -1.0f;       ///< [rad] from the object to the camera, counter-clockwise from +x
    float elevation = 0.2f;      ///< [rad] of the camera above the horizon
    float field_of_view = 0.5f;  ///< [rad] across the longer side of the image
    float margin = 0.04f;        ///< fraction of the image that remains free on each side
    std::optional<Vec3d>
        look_at;     ///< [m] world: point at the centre of the image; by default the centre of the object
    float zoom = 1;  ///< magnification at the same position of the camera
    float sun_azimuth = -0.9f;    ///< [rad] from the direction of the camera to the sun, counter-clockwise
    float sun_elevation = 0.85f;  ///< [rad] of the sun above the horizon
    /// `deviation`, `distance` and `evidence` require those of RenderScene; `plain` points have their own
    /// colours.
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

template <class Self, class Visitor>
requires SameOptions<Self, RenderOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("width", "Width of the image in pixels.", Unit::none, 16, 16384), o.width);
    visit(common_field("height", "Height of the image in pixels.", Unit::none, 16, 16384), o.height);
    visit(Field{"samples", "Number of rays per pixel; more are slower and reduce the noise.", Unit::none, 1,
                4096},
          o.samples);
    visit(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above.",
                       Unit::radian, -6.2832, 6.2832),
          o.azimuth);
    visit(common_field("elevation", "Height of the camera above the horizon.", Unit::radian, -1.5708, 1.5708),
          o.elevation);
    visit(Field{"field_of_view", "Field of view of the camera across the longer side of the image.",
                Unit::radian, 0.01, 2.5},
          o.field_of_view);
    visit(Field{"margin", "Fraction of the image that remains free on each side.", Unit::none, 0, 0.45},
          o.margin);
    visit(Field{"look_at",
                "Point at the centre of the image, as 0.5,-2,13; by default the centre of the object.",
                Unit::metre},
          o.look_at);
    visit(common_field("zoom", "Magnification; 1 fits the whole object into the image.", Unit::none, 0.01,
                       10000),
          o.zoom);
    visit(Field{"sun_azimuth", "Direction of the sun, counter-clockwise from the camera.", Unit::radian,
                -6.2832, 6.2832},
          o.sun_azimuth);
    visit(Field{"sun_elevation", "Height of the sun above the horizon.", Unit::radian, 0.05, 1.5708},
          o.sun_elevation);
    visit(common_field("color",
                       "Colour of the surface: plain, magenta for overlays (signal), or a quantity: "
                       "deviation and distance are blue inside and red outside, evidence is blue where radii "
                       "were measured and red where they were estimated."),
          o.color);
    visit(Field{"deviation_range", "Deviation from the radius that has the full colour.", Unit::radius, 1e-4,
                10},
          o.deviation_range);
    visit(Field{"distance_range",
                "Distance that has the full colour; 0 uses the 98 % quantile over the vertices or points.",
                Unit::metre, 0, 1e6},
          o.distance_range);
    visit(common_field("wireframe", "Draw the edges of the faces."), o.wireframe);
    visit(Field{"wire_width", "Width of the edges in pixels.", Unit::none, 0.2, 20}, o.wire_width);
    visit(Field{"flat", "Show faces flat, without smoothing across edges."}, o.flat);
    visit(Field{"ground", "Draw a ground that receives the shadow."}, o.ground);
    visit(Field{"transparent", "Leave the background transparent."}, o.transparent);
    visit(
        Field{"axis_width", "Thickness of a skeleton that is visible through a mesh.", Unit::radius, 0.01, 1},
        o.axis_width);
}

/// Draws the scene with sun and sky light [Wald2014]. `distance` shows for every point of the mesh, or of the
/// cloud, how far outside the other surface it is, as in figure 10 of [Zhu2015]; it requires one search for
/// each sample, or point. The result does not depend on the number of threads; the time is that of building a
/// tree over the faces (about n log n) plus that of up to three rays per sample. Throws InvalidInput for an
/// empty scene, options out of range, more than 128 million pixels, positions that are not finite, or a
/// look_at behind the camera; Cancelled if stopped.
Image render(const RenderScene& scene, const RenderOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
