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

/// What marching as printed makes.
struct PrintedMarch {
    std::uint64_t tetra = 0;      ///< of the last level
    std::uint64_t vertices = 0;   ///< of the last level, all sampled
    std::uint64_t triangles = 0;  ///< each with corners of its own
    TriMesh mesh;                 ///< the same triangles, welded; empty if not asked for
};

/// Marches on a card. Keeps the memory that a call took for the next one. One call at a time.
class DeviceMarcher {
  public:
    /// Takes `most` bytes of the card at most. Throws DeviceError where there is no card, or this build has
    /// no kernels.
    explicit DeviceMarcher(const Context& ctx = {},
                           std::size_t most = std::numeric_limits<std::size_t>::max());
    ~DeviceMarcher();                                    ///< gives the memory back
    DeviceMarcher(DeviceMarcher&&) noexcept;             ///< leaves the other one empty
    DeviceMarcher& operator=(DeviceMarcher&&) noexcept;  ///< leaves the other one empty

    /// See march() of coppice/tetra. The coarse mesh and the segments go to the card, and triangles come
    /// back; what counts in each region of the field is found there as well, whatever regions were set.
    /// Positions agree to 1e-4 of the local radius; where a vertex is as near to the surface as it may be to
    /// be moved, rounding may decide otherwise.
    ///
    /// What is too large for the card at once (see cuda/tetra/march_input.h) is done in pieces, to the same
    /// bits. Throws DeviceError when it has too little memory for that as well, fails, or where more segments
    /// meet than longest_list(), and what march() throws.
    MarchResult march(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                      const MarchOptions& options, const Context& ctx = {});

    /// As [Zhu2013] prints it: tetrahedra written down level by level, each cut along its own shortest
    /// diagonal, no snapping, vertices by the straight line between two values. Some 150 bytes of the card
    /// per tetrahedron of the last level. Throws as march().
    PrintedMarch march_as_printed(const TetraMesh& mesh, int levels, const CutConvolution& field, bool weld,
                                  const Context& ctx = {});
    /// The last one of both once more, from the coarse tetrahedra and the segments, which lie on the card, to
    /// the triangles, which stay there (of the second, with corners of their own), for measuring. Waits.
    /// Throws DeviceError after one in pieces.
    void repeat();

    /// From now on the time of every kernel is noted.
    void measure();
    /// What was noted since it was asked for the last time.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the card, by the last call

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice
