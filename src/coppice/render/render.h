#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/painted_points.h"
#include "coppice/render/image.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/sketch/view.h"

namespace coppice {

/// What the colour of a surface shows.
enum class RenderColor {
    plain,      ///< clay
    signal,     ///< magenta, as neither bark nor leaves nor sky are
    deviation,  ///< see RenderScene
    distance,   ///< see RenderScene
    evidence,   ///< see RenderScene
};

template <>
struct EnumNames<RenderColor> {
    static constexpr std::array<std::string_view, 5> names{"plain", "signal", "deviation", "distance",
                                                           "evidence"};
};

/// A place to point at.
struct RenderMark {
    Vec3d place;        ///< [m] in the world, origins added
    double radius = 0;  ///< [m] of what is there
};

/// What to draw; refers to values that must outlive the call.
///
/// A mesh alone is drawn as a solid, points as balls, of more than four million evenly as many as that; a
/// skeleton alone as round cones with its radii; together with either its axis shines through. Points that
/// have colours lie on a pale mesh. Marked faces stand out in magenta on a pale mesh, and shine through where
/// they are hidden. The origins of all are respected.
struct RenderScene {
    const PolygonMesh* mesh = nullptr;     ///< the surface, if any
    const PaintedPoints* cloud = nullptr;  ///< points, if any
    float point_radius = 0;                ///< [m] of the points; > 0
    const Skeleton* skeleton = nullptr;    ///< the skeleton, if any
    std::span<const float>
        deviation;  ///< per mesh vertex: distance outside the true surface / radius; NaN = unknown
    std::span<const float> evidence;  ///< per node of the skeleton: share of measures in its radius, 0 to 1
    std::span<const std::uint32_t> marked_faces;  ///< of the mesh
    std::span<const RenderMark> marks;            ///< places to draw rings around, large enough to be seen
    /// Another surface, from which the points are measured that have no distances of their own, or the mesh
    /// where there are no points.
    const SurfaceTree* distance_to = nullptr;
    const SketchView* view = nullptr;  ///< the camera, if it does not frame the object by itself
    /// [m] in the world: points that the camera frames in place of the object, as in pictures that follow
    /// each other. The ground lies as low as the lowest.
    std::span<const Vec3d> framed;
};

/// How to draw it. The camera stands where the whole object just fills the picture, and looks from there.
struct RenderOptions {
    int width = 1024;              ///< [pixels]
    int height = 1024;             ///< [pixels]
    int samples = 16;              ///< per pixel; noise falls with its square root
    float azimuth = -1.0f;         ///< [rad] from the object to the camera, counter-clockwise from +x
    float elevation = 0.2f;        ///< [rad] of the camera above the horizon
    float field_of_view = 0.5f;    ///< [rad] across the longer side of the picture
    float margin = 0.04f;          ///< of the picture left free on each side
    std::optional<Vec3d> look_at;  ///< [m] world: stands in the middle of the picture; else the object does
    float zoom = 1;                ///< how many times larger things are, the camera staying where it is
    float sun_azimuth = -0.9f;     ///< [rad] from the camera's side to the sun, counter-clockwise
    float sun_elevation = 0.85f;   ///< [rad] of the sun above the horizon
    /// `deviation`, `distance` and `evidence` need those of RenderScene; `plain` points have the colours of
    /// their own.
    RenderColor color = RenderColor::plain;
    float deviation_range = 0.1f;  ///< [radius] deviation drawn in full colour
    float distance_range =
        0;  ///< [m] distance drawn in full colour; 0 = that of 98 % of the vertices or points
    bool wireframe = false;    ///< draws the edges of the faces
    float wire_width = 1.0f;   ///< [pixels]
    bool flat = false;         ///< shows faces as they are, without smoothing of normals
    bool ground = true;        ///< a ground that receives the shadow
    bool transparent = false;  ///< leaves the background out
    float axis_width = 0.15f;  ///< [radius] of the skeleton where it shines through a mesh
};

template <class Self, class Visitor>
requires SameOptions<Self, RenderOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("width", "Width of the picture in pixels", Unit::none, 16, 16384), o.width);
    visit(common_field("height", "Height of the picture in pixels", Unit::none, 16, 16384), o.height);
    visit(Field{"samples", "rays per pixel; more is slower and less noisy", Unit::none, 1, 4096}, o.samples);
    visit(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above",
                       Unit::radian, -6.2832, 6.2832),
          o.azimuth);
    visit(common_field("elevation", "Height of the camera above the horizon", Unit::radian, -1.5708, 1.5708),
          o.elevation);
    visit(Field{"field_of_view", "opening of the camera across the longer side", Unit::radian, 0.01, 2.5},
          o.field_of_view);
    visit(Field{"margin", "part of the picture left free on each side", Unit::none, 0, 0.45}, o.margin);
    visit(
        Field{"look_at", "point that stands in the middle of the picture, as 0.5,-2,13; else the object does",
              Unit::metre},
        o.look_at);
    visit(common_field("zoom", "Magnification; 1 fits the whole object into the picture", Unit::none, 0.01,
                       10000),
          o.zoom);
    visit(Field{"sun_azimuth", "where the sun stands, counter-clockwise from the camera", Unit::radian,
                -6.2832, 6.2832},
          o.sun_azimuth);
    visit(Field{"sun_elevation", "height of the sun above the horizon", Unit::radian, 0.05, 1.5708},
          o.sun_elevation);
    visit(common_field("color",
                       "Colour of the surface: plain, magenta for overlays (signal), or a quantity: "
                       "deviation and distance are blue inside and red outside, evidence is blue where radii "
                       "were measured and red where they were estimated"),
          o.color);
    visit(Field{"deviation_range", "deviation from the radius drawn in full colour", Unit::radius, 1e-4, 10},
          o.deviation_range);
    visit(Field{"distance_range",
                "distance drawn in full colour; 0 takes what 98 % of the vertices or points keep below",
                Unit::metre, 0, 1e6},
          o.distance_range);
    visit(common_field("wireframe", "Draw the edges of the faces"), o.wireframe);
    visit(Field{"wire_width", "width of those edges in pixels", Unit::none, 0.2, 20}, o.wire_width);
    visit(Field{"flat", "shows faces as they are, without smoothing across edges"}, o.flat);
    visit(Field{"ground", "a ground that receives the shadow"}, o.ground);
    visit(Field{"transparent", "leaves the background out"}, o.transparent);
    visit(Field{"axis_width", "thickness of a skeleton that shines through a mesh", Unit::radius, 0.01, 1},
          o.axis_width);
}

/// Draws the scene with sun and sky light [Wald2014]. `distance` shows at every place of the mesh, or of each
/// point of the cloud, how far outside of the other surface it lies, after figure 10 of [Zhu2015]; that costs
/// one search for each sample, or point.
/// The same bits for any number of threads; the time is that of building a tree over the faces (about n log
/// n) plus that of up to three rays per sample. Throws InvalidInput for an empty scene, options out of range,
/// more than 128 million pixels, positions that are not finite, or a look_at behind the camera; Cancelled
/// when stopped.
Image render(const RenderScene& scene, const RenderOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
