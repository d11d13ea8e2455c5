#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/statistics.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/render/image.h"
#include "coppice/view/surface_backend.h"
#include "coppice/view/view_options.h"

namespace coppice {

/// Seconds of all frames; parts of a frame follow each other in this order.
struct FrameTimes {
    Statistics edit;     ///< the branch's nodes, cage and anchors are moved
    Statistics surface;  ///< the cage is refined, moved onto the field, and given normals
    Statistics upload;   ///< vertices are brought to where they are drawn
    Statistics draw;     ///< until the picture stands on the device
    Statistics frame;    ///< all of it
};

/// Calls visit(name, statistics) for every member, in order.
template <class Visitor>
void visit_figures(const FrameTimes& t, Visitor&& visit) {
    visit("edit", t.edit);
    visit("surface", t.surface);
    visit("upload", t.upload);
    visit("draw", t.draw);
    visit("frame", t.frame);
}

/// What was dragged, and how fast.
struct EditDemoResult {
    std::string renderer;          ///< what drew, as its maker calls it
    std::string opengl;            ///< its version
    std::string backend;           ///< what made the surfaces
    std::string note;              ///< see SurfaceBackend
    std::uint32_t branch = 0;      ///< id of the branch's first node, as in the prepared skeleton
    std::uint32_t segments = 0;    ///< that were dragged
    std::uint32_t quads = 0;       ///< that were drawn
    std::uint32_t vertices = 0;    ///< of these
    std::uint32_t written = 0;     ///< vertices that a frame made anew
    std::uint32_t frames = 0;      ///< that were drawn
    double frames_per_second = 0;  ///< of all of them
    FrameTimes seconds;            ///< of a frame and its parts
    std::vector<Image>
        pictures;  ///< four frames, from the first to the last, or fewer where there are not as many
};

/// Drags a branch of the tree to and fro in the plane of the picture, and draws every frame: one swing and a
/// quarter, from rest to the greatest angle. Pictures are taken outside of what is timed.
///
/// Throws InvalidInput where the tree has no branch or an option is out of range, Unsupported where OpenGL
/// cannot be had, and what the backend throws.
EditDemoResult edit_demo(const QuadModel& model, const EditDemoOptions& demo, const ViewOptions& options,
                         SurfaceBackend& backend, const Context& ctx = {});

/// A surface that is drawn once.
struct ViewResult {
    Image picture;         ///< of the surface
    std::string renderer;  ///< what drew, as its maker calls it
    std::string opengl;    ///< its version
};

/// Draws a surface. Throws as above.
ViewResult view_surface(const PolygonMesh& mesh, const ViewOptions& options);

}  // namespace coppice
