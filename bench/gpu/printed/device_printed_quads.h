#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"
#include "coppice/mesh/mesh.h"
#include "printed_quad_kernels.h"

namespace coppice::bench {

/// Creates quads of closed cages on a GPU as published in [Zhu2015] (see PrintedQuadStages), for comparison
/// with DeviceQuads. Reuses the memory of a job for the next one. One job at a time.
class DevicePrintedQuads {
  public:
    /// Throws DeviceError if there is no GPU, or this build contains no kernels.
    explicit DevicePrintedQuads(const Context& ctx = {});
    ~DevicePrintedQuads();                                         ///< releases the memory
    DevicePrintedQuads(DevicePrintedQuads&&) noexcept;             ///< leaves the source empty
    DevicePrintedQuads& operator=(DevicePrintedQuads&&) noexcept;  ///< leaves the source empty

    /// Subdivides the cage of a job, moves it onto a field with its regions, and copies the result to the
    /// host. Throws InvalidInput for a cage with a boundary, and DeviceError if the GPU fails or has too
    /// little memory.
    QuadMesh make(const cuda::QuadJob& job, const ConvolutionField& field, const Evolution& how = {});

    /// Repeats the work of the last make() with the data on the GPU, for measurements: without copying the
    /// result. Waits.
    void repeat();

    /// Enables recording of the time of every kernel.
    void measure();
    /// Returns the times recorded since the last call.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the GPU, by the last job

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice::bench
