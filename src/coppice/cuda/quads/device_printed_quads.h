#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/quads/printed_quad_kernels.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Makes quads of closed cages on a card as [Zhu2015] prints it (see PrintedQuadStages), to be compared with
/// DeviceQuads. Keeps the memory that a job took for the next one. One job at a time.
class DevicePrintedQuads {
  public:
    /// Throws DeviceError where there is no card, or this build has no kernels.
    explicit DevicePrintedQuads(const Context& ctx = {});
    ~DevicePrintedQuads();                                         ///< gives the memory back
    DevicePrintedQuads(DevicePrintedQuads&&) noexcept;             ///< leaves the other one empty
    DevicePrintedQuads& operator=(DevicePrintedQuads&&) noexcept;  ///< leaves the other one empty

    /// Subdivides a job's cage, moves it onto a field with its regions, and copies it back. Throws
    /// InvalidInput for a cage with a boundary, and DeviceError when the card fails or has too little memory.
    QuadMesh make(const cuda::QuadJob& job, const ConvolutionField& field, const cuda::Evolution& how = {});

    /// The work of the last make() once more from what lies on the card, for measuring: without copying it
    /// back. Waits.
    void repeat();

    /// From now on the time of every kernel is noted.
    void measure();
    /// What was noted since it was asked for the last time.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the card, by the last job

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice
