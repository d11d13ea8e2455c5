#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/drag/drag_job.h"

namespace coppice {

/// Buffers of OpenGL that a surface is drawn from, three floats for each vertex.
struct DrawnBuffers {
    std::uint32_t positions = 0;  ///< name of a buffer object
    std::uint32_t normals = 0;    ///< name of a buffer object
};

/// The card that draws in the OpenGL context that is current, as CUDA counts them; -1 where it knows of none.
int drawing_device();

/// Makes the frames of a surface of which a part moves on a card, and writes them straight into the buffers
/// that it is drawn from. Topology is the same as on the CPU, positions agree within 1e-4 of the local
/// radius. Memory is taken once, but where the field's lists grow.
class DeviceDrag {
  public:
    /// Of the card that CUDA gives this number. Throws DeviceError where there is none, or this build has no
    /// kernels.
    explicit DeviceDrag(int device, const Context& ctx = {});
    ~DeviceDrag();  ///< gives buffers and memory back; the context of the buffers is current
    DeviceDrag(const DeviceDrag&) = delete;             ///< it holds what is on the card
    DeviceDrag& operator=(const DeviceDrag&) = delete;  ///< it holds what is on the card

    const std::string& name() const;  ///< of the card, as its maker calls it

    /// From now on frames are written into these buffers, of which all that frames do not write stays. Their
    /// context is current here and in make(). Throws DeviceError where the card does not draw from them.
    void attach(const DrawnBuffers& buffers);
    /// Copies all that stays the same, and makes the frame at rest. The job must outlive this. Throws
    /// DeviceError where the card has too little memory or cannot make the field's lists.
    void begin(const cuda::DragJob& job, const cuda::DragMoves& rest);
    /// Makes a frame, and waits for it. Throws DeviceError when the card failed.
    void make(const cuda::DragMoves& moves);
    /// Copies back what the last frame wrote: the first positions and normals, as many as there are places.
    /// Only without buffers.
    void download(std::span<Vec3> positions, std::span<Vec3> normals);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice
