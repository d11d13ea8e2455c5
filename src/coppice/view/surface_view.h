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

/// A surface to draw; refers to values that are copied to the device.
struct DrawnSurface {
    std::span<const Vec3> positions;      ///< [m]
    std::span<const Vec3> normals;        ///< unit, one per position
    std::span<const Triangle> triangles;  ///< counter-clockwise from outside
    /// Highlighting of each vertex by colour, 0 to 1; empty: none.
    std::span<const float> marked = {};
};

/// The OpenGL buffers from which a surface is drawn, for code that writes into them. Each contains three
/// floats per vertex.
struct VertexBuffers {
    std::uint32_t positions = 0;     ///< name of a buffer object: [m]
    std::uint32_t normals = 0;       ///< name of a buffer object: unit vectors
    std::uint32_t vertex_count = 0;  ///< number of vertices in each
};

/// Replaces the first vertices by those of the host. The context of the buffers must be current.
void write_vertices(const VertexBuffers& buffers, std::span<const Vec3> positions,
                    std::span<const Vec3> normals);

/// Draws one surface into one image, by OpenGL and without a window. Quads are drawn as two triangles, split
/// once along the diagonal that is shorter at rest: every device draws indexed triangles at full speed, while
/// quad primitives would require a geometry shader, and smooth normals hide the diagonal.
///
/// Light from sky, ground and a sun, wood on a plain background. Images of the same device are bit-identical.
class SurfaceView {
  public:
    /// The camera uses the frame of the positions, is perspective, and has no lens distortion; `near` and
    /// `far` follow from the positions and from `reached`, later positions of vertices. Throws Unsupported if
    /// OpenGL is not available or too limited for the image or the surface.
    SurfaceView(const DrawnSurface& surface, const SketchView& camera, const ViewOptions& options,
                std::span<const Vec3> reached = {});
    ~SurfaceView();                                       ///< releases all memory of the device
    SurfaceView(const SurfaceView&) = delete;             ///< not copyable
    SurfaceView& operator=(const SurfaceView&) = delete;  ///< not copyable

    const OffscreenContext& context() const;  ///< current during the lifetime of the view
    const VertexBuffers& buffers() const;     ///< of the surface

    void draw();            ///< returns when the image is complete on the device
    Image picture() const;  ///< the last image

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
