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

/// Makes quads of cages on a card: what PatchRefinement::refine, project and untangle do, with the same
/// topology and positions within 1e-4 of the local radius. Keeps the memory that a job took for the next one.
/// One job at a time, or several as one: see cuda::QuadRun. What has no room on the card as a whole is done
/// in rounds.
class DeviceQuads {
  public:
    /// Takes `most` bytes of the card at most. Throws DeviceError where there is no card, or this build has
    /// no kernels.
    explicit DeviceQuads(const Context& ctx = {}, std::size_t most = std::numeric_limits<std::size_t>::max());
    ~DeviceQuads();                                  ///< gives the memory back
    DeviceQuads(DeviceQuads&&) noexcept;             ///< leaves the other one empty
    DeviceQuads& operator=(DeviceQuads&&) noexcept;  ///< leaves the other one empty

    /// Sends a job and the field with its regions, and begins with it: returns before it is done. What it
    /// refers to has to outlive finish(). Throws DeviceError when the card has too little memory even for a
    /// small piece of it.
    void begin(const cuda::QuadJob& job, const ConvolutionField& field);
    /// The same of several jobs at once, each with a field of its own: of the same levels and options.
    void begin(std::span<const cuda::QuadTask> tasks);
    /// The same of a field without regions: the card finds what counts in each. False where lists are so long
    /// that they have to be made on the CPU.
    bool begin(const cuda::QuadJob& job, const cuda::ContactInput& contacts);
    /// The same of several jobs at once: one of `contacts` for each. False also where the card has not room
    /// for all of them.
    bool begin(std::span<const cuda::QuadJob> jobs, std::span<const cuda::ContactInput> contacts);
    /// Waits, unfolds what was folded, and copies back the refined positions, and where it is asked for the
    /// refined anchors. Throws DeviceError when the card failed. A job that was done in pieces is not
    /// unfolded.
    cuda::QuadReport finish(Buffer<Vec3>& positions, Buffer<Vec3>* anchors = nullptr);
    /// The same of several jobs: one of `out` for each.
    std::vector<cuda::QuadReport> finish(std::span<const cuda::QuadPlaces> out);

    /// The work of begin() and finish() once more from what lies on the card, for measuring: with normals and
    /// quads, but without copying them back. Waits. After finish(), of jobs that were one round.
    void repeat();
    std::size_t rounds() const;  ///< that the jobs begun last took so far; 1 where all had room at once

    /// From now on the time of every kernel is noted.
    void measure();
    /// What was noted since it was asked for the last time.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the card, by the job begun last

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Memory of the card that a job takes, if not more than a fiftieth of its quads is folded, about a field of
/// so many segments whose lists have so many entries.
std::uint64_t bytes_of(const cuda::QuadJob& job, std::uint64_t segments, std::uint64_t entries);

}  // namespace coppice
