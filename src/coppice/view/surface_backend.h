#pragma once

#include <memory>
#include <string>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/pipeline/drag/branch_drag.h"
#include "coppice/pipeline/drag/drag_part.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/view/surface_view.h"

namespace coppice {

/// A branch that is dragged, and all that stays the same meanwhile.
struct DragScene {
    const QuadModel& model;  ///< cage, anchors, regions and the skeleton of the field at rest
    const BranchDrag& drag;  ///< which of these move
    const DragPart& part;    ///< the quads that change, and the order of vertices in the buffers
};

/// What makes the surface of each frame: the cage of the part refined, moved onto the field of the posed
/// skeleton, with normals, as DraggedSurface has them; topology is the same, positions agree within 1e-4 of
/// the local radius.
class SurfaceBackend {
  public:
    SurfaceBackend() = default;                                 ///< nothing yet
    virtual ~SurfaceBackend() = default;                        ///< after end(), if it began
    SurfaceBackend(const SurfaceBackend&) = delete;             ///< it is one
    SurfaceBackend& operator=(const SurfaceBackend&) = delete;  ///< it is one

    /// What it runs on, in a word or two; once it has begun.
    virtual std::string name() const = 0;
    /// Where a card was asked for and did not do the work, why: a sentence. Else empty.
    virtual std::string note() const { return {}; }
    /// Called once, before any frame. The buffers hold the surface at rest in the order of the part's drawn
    /// vertices, and their context is current here and in all later calls; scene and buffers stay where they
    /// are as long as frames are made.
    virtual void begin(const DragScene& scene, const VertexBuffers& buffers, const Context& ctx) = 0;
    /// Makes the surface of a pose, of which only what DragScene::drag names differs from rest. Done when it
    /// returns, so that its time is that of the surface.
    virtual void make(const DragPose& pose, const Context& ctx) = 0;
    /// Brings what make() made into the first `part.written` positions and the first `part.shaded` normals of
    /// the buffers, if it is not there yet. What is drawn next shows it.
    virtual void deliver() = 0;
    /// Called once after the last frame, also where that failed: lets go of the scene and the buffers, which
    /// go soon. Does not throw.
    virtual void end() noexcept = 0;
};

/// Makes surfaces on the CPU and sends the vertices that changed.
std::unique_ptr<SurfaceBackend> cpu_backend();

/// Makes surfaces where it is told to. A card writes them straight into the buffers that it draws from; one
/// that does not draw sends them by way of the host, if it is asked for by name. Device::automatic takes the
/// card that draws, where CUDA knows it. Where there is none, the CPU makes them, but Device::cuda throws
/// DeviceError. Where the card fails, the CPU goes on, with a note.
std::unique_ptr<SurfaceBackend> surface_backend(Device wanted);

}  // namespace coppice
