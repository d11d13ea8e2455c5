#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice::bench {

/// Marches on a GPU as published in [Zhu2013], for comparison with DeviceMarcher: explicit tetrahedra on
/// every level, each cut along its own shortest diagonal, no snapping, vertices by linear interpolation
/// between two values. Reuses the memory of a call for the next one. One call at a time.
class DevicePrintedMarch {
  public:
    /// Throws DeviceError if there is no GPU, or this build contains no kernels.
    explicit DevicePrintedMarch(const Context& ctx = {});
    ~DevicePrintedMarch();                                         ///< releases the memory
    DevicePrintedMarch(DevicePrintedMarch&&) noexcept;             ///< leaves the source empty
    DevicePrintedMarch& operator=(DevicePrintedMarch&&) noexcept;  ///< leaves the source empty

    /// Returns the welded triangles. Requires about 150 bytes of the GPU per tetrahedron of the last level.
    /// Throws DeviceError if the GPU fails or has too little memory, and the exceptions of TetraRefinement.
    TriMesh make(const TetraMesh& mesh, int levels, const CutConvolution& field, const Context& ctx = {});

    /// Repeats the last make() for measurements, from the coarse tetrahedra and the segments on the GPU to
    /// the unwelded triangles, which stay there. Waits.
    void repeat();

    /// Enables recording of the time of every kernel.
    void measure();
    /// Returns the times recorded since the last call.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the GPU, by the last call

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice::bench
