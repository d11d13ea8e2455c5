#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/tetra/march/march.h"

namespace coppice {

/// Marches on a GPU. Reuses the memory of a call for the next one. One call at a time.
class DeviceMarcher {
  public:
    /// Uses at most `most` bytes of the GPU. Throws DeviceError if there is no GPU, or this build contains no
    /// kernels.
    explicit DeviceMarcher(const Context& ctx = {},
                           std::size_t most = std::numeric_limits<std::size_t>::max());
    ~DeviceMarcher();                                    ///< releases the memory
    DeviceMarcher(DeviceMarcher&&) noexcept;             ///< leaves the source empty
    DeviceMarcher& operator=(DeviceMarcher&&) noexcept;  ///< leaves the source empty

    /// See march() of coppice/tetra. Uploads the coarse mesh and the segments, and downloads triangles; the
    /// active segments of each region are found on the GPU, independently of regions that were set. Positions
    /// agree to 1e-4 of the local radius; if the distance of a vertex from the surface equals the limit for
    /// moving it, rounding may decide differently.
    ///
    /// Input that is too large for the GPU (see cuda/tetra/march_input_internal.h) is processed in tiles,
    /// with a bit-identical result. Throws DeviceError if the GPU has too little memory for that as well, if
    /// it fails, or if more segments meet than longest_list(), and the exceptions of march().
    MarchResult march(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                      const MarchOptions& options, const Context& ctx = {});

    /// Repeats the last march() for measurements, from the coarse tetrahedra and the segments on the GPU to
    /// the triangles, which stay there. Waits. Throws DeviceError after a march in tiles.
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

}  // namespace coppice
