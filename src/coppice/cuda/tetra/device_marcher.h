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

/// Result of marching as published.
struct PrintedMarch {
    std::uint64_t tetra = 0;      ///< of the last level
    std::uint64_t vertices = 0;   ///< of the last level, all sampled
    std::uint64_t triangles = 0;  ///< each with its own corners
    TriMesh mesh;                 ///< the same triangles, welded; empty if not requested
};

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
    /// Input that is too large for the GPU (see cuda/tetra/march_input.h) is processed in tiles, with a
    /// bit-identical result. Throws DeviceError if the GPU has too little memory for that as well, if it
    /// fails, or if more segments meet than longest_list(), and the exceptions of march().
    MarchResult march(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                      const MarchOptions& options, const Context& ctx = {});

    /// Marches as published in [Zhu2013]: explicit tetrahedra on every level, each cut along its own shortest
    /// diagonal, no snapping, vertices by linear interpolation between two values. About 150 bytes of the GPU
    /// per tetrahedron of the last level. Throws as march().
    PrintedMarch march_as_printed(const TetraMesh& mesh, int levels, const CutConvolution& field, bool weld,
                                  const Context& ctx = {});
    /// Repeats the last call of either function for measurements, from the coarse tetrahedra and the segments
    /// on the GPU to the triangles, which stay there (unwelded for march_as_printed). Waits. Throws
    /// DeviceError after a call in tiles.
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
