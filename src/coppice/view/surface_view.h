#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "coppice/mesh/mesh.h"
#include "coppice/render/image.h"
#include "coppice/sketch/view.h"
#include "coppice/view/offscreen_context.h"
#include "coppice/view/view_options.h"

namespace coppice {

/// A surface as it is drawn; refers to values that are copied to the device.
struct DrawnSurface {
    std::span<const Vec3> positions;      ///< [m]
    std::span<const Vec3> normals;        ///< unit, one per position
    std::span<const Triangle> triangles;  ///< counter-clockwise from outside
    /// How much a vertex is of what stands out by its colour, 0 to 1; empty: nothing does.
    std::span<const float> marked = {};
};

/// The buffers of OpenGL that a surface is drawn from, for those who write into them by whatever means. Each
/// holds three floats for each vertex, one vertex after the other.
struct VertexBuffers {
    std::uint32_t positions = 0;     ///< name of a buffer object: [m]
    std::uint32_t normals = 0;       ///< name of a buffer object: unit vectors
    std::uint32_t vertex_count = 0;  ///< in each
};

/// Replaces the first vertices by those of the host. The context of the buffers has to be current.
void write_vertices(const VertexBuffers& buffers, std::span<const Vec3> positions,
                    std::span<const Vec3> normals);

/// One surface on one picture, by OpenGL and without a window. Quads come as two triangles, cut once, where
/// they are the shortest at rest: every device draws indexed triangles at full speed, while quads as
/// primitives would need a geometry shader, and normals are smooth, so that the cut is not seen.
///
/// Light from sky, ground and a sun, wood on a plain background. The same device gives the same picture, to
/// the bit.
class SurfaceView {
  public:
    /// The camera has the frame of the positions, is perspective, and its lens does not distort; `near` and
    /// `far` follow from the positions and from `reached`, places that vertices may come to later. Throws
    /// Unsupported where OpenGL cannot be had or is too small for the picture or the surface.
    SurfaceView(const DrawnSurface& surface, const SketchView& camera, const ViewOptions& options,
                std::span<const Vec3> reached = {});
    ~SurfaceView();                                       ///< gives all of the device back
    SurfaceView(const SurfaceView&) = delete;             ///< it is one
    SurfaceView& operator=(const SurfaceView&) = delete;  ///< it is one

    const OffscreenContext& context() const;  ///< current as long as the view is there
    const VertexBuffers& buffers() const;     ///< of the surface

    void draw();            ///< returns when the picture stands on the device
    Image picture() const;  ///< what was drawn last

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
