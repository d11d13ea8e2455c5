#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"

namespace coppice {

/// Creates quads of cages on a GPU: executes PatchRefinement::refine, project and untangle with the same
/// topology and positions within 1e-4 of the local radius. Reuses the memory of a job for the next one. One
/// job at a time, or several as one: see cuda::QuadRun. Work that does not fit on the GPU is done in rounds.
class DeviceQuads {
  public:
    /// Uses at most `most` bytes of the GPU. Throws DeviceError if there is no GPU, or this build contains no
    /// kernels.
    explicit DeviceQuads(const Context& ctx = {}, std::size_t most = std::numeric_limits<std::size_t>::max());
    ~DeviceQuads();                                  ///< releases the memory
    DeviceQuads(DeviceQuads&&) noexcept;             ///< leaves the source empty
    DeviceQuads& operator=(DeviceQuads&&) noexcept;  ///< leaves the source empty

    /// Uploads a job and the field with its regions, and starts the work without waiting. Referenced data
    /// must outlive finish(). Throws DeviceError if the GPU has too little memory even for a small tile.
    void begin(const cuda::QuadJob& job, const ConvolutionField& field);
    /// Starts several jobs at once, each with its own field. They must have the same levels and options.
    void begin(std::span<const cuda::QuadTask> tasks);
    /// Starts a job with a field without regions: the GPU finds the active segments of each region. Returns
    /// false if lists are so long that they must be computed on the CPU.
    bool begin(const cuda::QuadJob& job, const cuda::ContactInput& contacts);
    /// Starts several jobs at once, with one element of `contacts` for each. Also returns false if they do
    /// not all fit on the GPU.
    bool begin(std::span<const cuda::QuadJob> jobs, std::span<const cuda::ContactInput> contacts);
    /// Waits, unfolds folded quads, and copies the refined positions, and with `anchors` the refined anchors.
    /// Throws DeviceError if the GPU failed. A job that was done in tiles is not unfolded.
    cuda::QuadReport finish(Buffer<Vec3>& positions, Buffer<Vec3>* anchors = nullptr);
    /// Completes several jobs, with one element of `out` for each.
    std::vector<cuda::QuadReport> finish(std::span<const cuda::QuadPlaces> out);

    /// Repeats the work of begin() and finish() with the data on the GPU, for measurements: including normals
    /// and quads, but without copying results. Waits. Requires that finish() was called and the jobs took one
    /// round.
    void repeat();
    std::size_t rounds() const;  ///< number of rounds of the last jobs so far; 1 if all fitted at once

    /// Enables recording of the time of every kernel.
    void measure();
    /// Returns the times recorded since the last call.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the GPU, by the last job

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns the memory of the GPU that a job requires, if at most a fiftieth of its quads is folded, with a
/// field of this number of segments and list entries.
std::uint64_t count_bytes(const cuda::QuadJob& job, std::uint64_t segments, std::uint64_t entries);

}  // namespace coppice
