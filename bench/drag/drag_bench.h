#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/statistics.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/render/image.h"
#include "coppice/view/view_options.h"
#include "drag/surface_backend.h"

namespace coppice::bench {

/// Options of dragging a branch back and forth.
struct DragOptions {
    int frames = 240;    ///< number of drawn frames, at least 1
    int segments = 500;  ///< approximate size of the branch, at least 1: see branch_of_about
    double swing = 20 * std::numbers::pi / 180;  ///< [rad] maximum angle to both sides of rest
};

/// Statistics of the times of all frames [s]; the steps of a frame have this order.
struct FrameTimes {
    Statistics edit;     ///< time to move the nodes, cage and anchors of the branch
    Statistics surface;  ///< time to refine the cage, project it onto the field, and compute normals
    Statistics upload;   ///< time to copy the vertices to the drawing device
    Statistics draw;     ///< until the image is complete on the device
    Statistics frame;    ///< the whole frame
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

/// The dragged branch and the speed.
struct DragFigures {
    std::string renderer;          ///< name of the OpenGL renderer
    std::string opengl;            ///< version of OpenGL
    std::string backend;           ///< name of the backend
    std::string note;              ///< see SurfaceBackend
    std::uint32_t branch = 0;      ///< id of the first node of the branch, in the prepared skeleton
    std::uint32_t segments = 0;    ///< number of dragged segments
    std::uint32_t quads = 0;       ///< number of drawn quads
    std::uint32_t vertices = 0;    ///< number of drawn vertices
    std::uint32_t written = 0;     ///< number of vertices that a frame recomputes
    std::uint32_t frames = 0;      ///< number of drawn frames
    double frames_per_second = 0;  ///< over all frames
    FrameTimes seconds;            ///< of a frame and its steps
    std::vector<Image> pictures;   ///< at most four frames, evenly spaced from the first to the last
};

/// Calls visit(name, value) for every figure except the times, in order.
template <class Visitor>
void visit_figures(const DragFigures& r, Visitor&& visit) {
    visit("renderer", r.renderer);
    visit("opengl", r.opengl);
    visit("surfaces_by", r.backend);
    visit("branch", r.branch);
    visit("segments", r.segments);
    visit("quads", r.quads);
    visit("vertices", r.vertices);
    visit("vertices_of_a_frame", r.written);
    visit("frames", r.frames);
    visit("frames_per_second", r.frames_per_second);
}

/// Drags a branch of the tree back and forth in the image plane, and draws every frame: one and a quarter
/// periods, from rest to the maximum angle. Images are stored outside the measured times.
///
/// Throws InvalidInput if the tree has no branch or an option of the view is out of range, Unsupported if
/// OpenGL is not available, and the exceptions of the backend.
DragFigures measure_drag(const QuadBuild& build, const DragOptions& dragging, const ViewOptions& options,
                         SurfaceBackend& backend, const Context& ctx = {});

}  // namespace coppice::bench
