#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "drag/drag_job.h"

namespace coppice::bench {

/// OpenGL buffers from which a surface is drawn, with three floats per vertex.
struct DrawnBuffers {
    std::uint32_t positions = 0;  ///< name of a buffer object
    std::uint32_t normals = 0;    ///< name of a buffer object
};

/// Returns the CUDA number of the GPU that draws in the current OpenGL context; -1 if CUDA does not know one.
int find_drawing_device();

/// Computes the frames of a partially moving surface on a GPU, and writes them directly into the buffers from
/// which it is drawn. Topology is the same as on the CPU, positions agree within 1e-4 of the local radius.
/// Memory is allocated once, except if the lists of the field grow.
class DeviceDrag {
  public:
    /// Uses the GPU with this CUDA number. Throws DeviceError if there is no such GPU, or this build contains
    /// no kernels.
    explicit DeviceDrag(int device, const Context& ctx = {});
    ~DeviceDrag();  ///< releases buffers and memory; the OpenGL context of the buffers must be current
    DeviceDrag(const DeviceDrag&) = delete;             ///< owns device memory
    DeviceDrag& operator=(const DeviceDrag&) = delete;  ///< owns device memory

    const std::string& name() const;  ///< name of the GPU as reported by the driver

    /// Writes later frames into these buffers; elements that frames do not write are preserved. The OpenGL
    /// context of the buffers must be current here and in make(). Throws DeviceError if the GPU does not draw
    /// from them.
    void attach(const DrawnBuffers& buffers);
    /// Copies all constant data and computes the frame at rest. The job must outlive this object. Throws
    /// DeviceError if the GPU has too little memory or cannot compute the lists of the field.
    void begin(const DragJob& job, const DragMoves& rest);
    /// Computes a frame and waits for it. Throws DeviceError if the GPU failed.
    void make(const DragMoves& moves);
    /// Copies the first positions.size() positions and normals.size() normals of the last frame. Only without
    /// shared buffers.
    void download(std::span<Vec3> positions, std::span<Vec3> normals);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice::bench
