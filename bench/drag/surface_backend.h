#pragma once

#include <memory>
#include <string>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/view/surface_view.h"
#include "drag/branch_drag.h"
#include "drag/drag_part.h"

namespace coppice::bench {

/// A dragged branch, and the data that are constant during the drag.
struct DragScene {
    const QuadBuild& build;  ///< cage, anchors, regions and the skeleton of the field at rest
    const BranchDrag& drag;  ///< the moving subset
    const DragPart& part;    ///< the quads that change, and the order of vertices in the buffers
};

/// Computes the surface of each frame: refines the cage of the affected region, projects it onto the field of
/// the posed skeleton, and computes normals, as DraggedSurface does; the topology is the same, positions
/// agree within 1e-4 of the local radius.
class SurfaceBackend {
  public:
    SurfaceBackend() = default;                                 ///< not begun
    virtual ~SurfaceBackend() = default;                        ///< requires end() if begin() was called
    SurfaceBackend(const SurfaceBackend&) = delete;             ///< not copyable
    SurfaceBackend& operator=(const SurfaceBackend&) = delete;  ///< not copyable

    /// Returns the name of the device, after begin().
    virtual std::string name() const = 0;
    /// Returns one sentence with the reason if a requested GPU did not do the work; otherwise empty.
    virtual std::string note() const { return {}; }
    /// Called once, before any frame. The buffers contain the surface at rest in the order of the drawn
    /// vertices of the region, and their context is current here and in all later calls; scene and buffers
    /// must stay valid until end().
    virtual void begin(const DragScene& scene, const VertexBuffers& buffers, const Context& ctx) = 0;
    /// Computes the surface of a pose, in which only the nodes of DragScene::drag differ from rest. Complete
    /// when it returns, so that its time is that of the surface.
    virtual void make(const DragPose& pose, const Context& ctx) = 0;
    /// Copies the result of make() to the first `part.written` positions and the first `part.shaded` normals
    /// of the buffers, unless it is already there. The next drawing shows it.
    virtual void deliver() = 0;
    /// Called once after the last frame, also after an error: releases the scene and the buffers, which are
    /// destroyed afterwards. Does not throw.
    virtual void end() noexcept = 0;
};

/// Creates a backend that computes surfaces on the CPU and uploads the changed vertices.
std::unique_ptr<SurfaceBackend> cpu_backend();

/// Creates a backend for the requested device. A GPU writes directly into the buffers from which it draws; a
/// GPU that does not draw copies through the host, if it is requested explicitly. Device::automatic uses the
/// GPU that draws, if CUDA supports it. Without such a GPU the CPU computes the surfaces, but Device::cuda
/// throws DeviceError. After an error of the GPU the CPU continues, with a note.
std::unique_ptr<SurfaceBackend> surface_backend(Device wanted);

}  // namespace coppice::bench
